#include "sim/wind_project.h"

#include "world/det_math.h"

namespace sahel::SAHEL_ISA_NAMESPACE {

namespace {

constexpr const char* k_name = "sim/wind_project";
constexpr float k_smooth_low = 2.0f; // waves shorter than four cells along an axis, of the five-point operator
constexpr float k_high = 8.0f;
constexpr int32_t k_smooth_steps = 3;

float five_point(const float* up, const float* here, const float* down, int32_t x) {
    return 4.0f * here[x] - ((here[x - 1] + here[x + 1]) + (up[x] + down[x]));
}

float largest(const WindPlane& p, double* rows) {
    for_each_row(k_name, p.nx, p.ny, [&](int32_t y) {
        const float* r = p.row(y);
        uint32_t most = 0; // bits of floats without sign are in the order of the floats
        for (int32_t x = 0; x < p.nx; ++x) {
            const uint32_t bits = det::bits_of(det::abs(r[x]));
            most = bits > most ? bits : most;
        }
        rows[y] = static_cast<double>(det::float_of(most));
    });
    double most = 0.0;
    for (int32_t y = 0; y < p.ny; ++y) most = rows[y] > most ? rows[y] : most;
    return static_cast<float>(most);
}

// In eight lanes along rows, then row by row: one order whatever the threads and the instruction set.
double dot(const WindPlane& a, const WindPlane& b, double* rows) {
    for_each_row(k_name, a.nx, a.ny, [&](int32_t y) {
        const float* p = a.row(y);
        const float* q = b.row(y);
        double lane[8] = {};
        int32_t x = 0;
        for (; x + 8 <= a.nx; x += 8)
            for (int32_t k = 0; k < 8; ++k) lane[k] += static_cast<double>(p[x + k]) * static_cast<double>(q[x + k]);
        for (int32_t k = 0; x < a.nx; ++x, ++k) lane[k] += static_cast<double>(p[x]) * static_cast<double>(q[x]);
        rows[y] = ((lane[0] + lane[4]) + (lane[1] + lane[5])) + ((lane[2] + lane[6]) + (lane[3] + lane[7]));
    });
    double sum = 0.0;
    for (int32_t y = 0; y < a.ny; ++y) sum += rows[y];
    return sum;
}

// e += p(S) r with the Chebyshev polynomial of [low, k_high], starting from the residual in l.r; or, `afresh`, from
// r = b and e = 0. l.r and l.d are used up. Saad: Iterative Methods for Sparse Linear Systems (2003), algorithm 12.1.
void chebyshev(const ProjectLevel& l, float low, int32_t steps, bool afresh, bool residual_after) {
    const float centre = 0.5f * (k_high + low);
    const float sigma = (k_high + low) / (k_high - low);
    const float first = 1.0f / centre;
    WindPlane d = l.d;
    WindPlane next = l.next;
    for_each_row(k_name, d.nx, d.ny, [&](int32_t y) {
        const float* b = l.b.row(y);
        float* r = l.r.row(y);
        float* to = d.row(y);
        float* e = l.e.row(y);
        if (afresh) {
            SAHEL_VECTORIZE
            for (int32_t x = 0; x < d.nx; ++x) {
                r[x] = b[x];
                to[x] = first * b[x];
                e[x] = to[x];
            }
            return;
        }
        SAHEL_VECTORIZE
        for (int32_t x = 0; x < d.nx; ++x) {
            to[x] = first * r[x];
            e[x] += to[x];
        }
    });
    float rho = 1.0f / sigma;
    for (int32_t step = 1; step < steps; ++step) {
        d.fill_ring(l.ring_x, l.ring_y);
        const float rho_next = 1.0f / (2.0f * sigma - rho);
        const float keep = rho_next * rho;
        const float add = 2.0f * rho_next / (0.5f * (k_high - low));
        rho = rho_next;
        for_each_row(k_name, d.nx, d.ny, [&](int32_t y) {
            const float* up = d.row(y - 1);
            const float* here = d.row(y);
            const float* down = d.row(y + 1);
            float* r = l.r.row(y);
            float* to = next.row(y);
            float* e = l.e.row(y);
            SAHEL_VECTORIZE
            for (int32_t x = 0; x < d.nx; ++x) {
                const float rest = r[x] - five_point(up, here, down, x);
                r[x] = rest;
                to[x] = keep * here[x] + add * rest;
                e[x] += to[x];
            }
        });
        const WindPlane last = d;
        d = next;
        next = last;
    }
    if (!residual_after) return;
    d.fill_ring(l.ring_x, l.ring_y);
    for_each_row(k_name, d.nx, d.ny, [&](int32_t y) {
        const float* up = d.row(y - 1);
        const float* here = d.row(y);
        const float* down = d.row(y + 1);
        float* r = l.r.row(y);
        SAHEL_VECTORIZE
        for (int32_t x = 0; x < d.nx; ++x) r[x] -= five_point(up, here, down, x);
    });
}

// The right side of the coarse grid: four times (its cells are twice as wide) the full weighting of the residual.
void restrict_residual(const ProjectLevel& fine, const ProjectLevel& coarse) {
    fine.r.fill_ring(fine.ring_x, fine.ring_y);
    for_each_row(k_name, 4 * coarse.b.nx, coarse.b.ny, [&](int32_t y) {
        const float* up = fine.r.row(2 * y) + 1;
        const float* here = fine.r.row(2 * y + 1) + 1;
        const float* down = fine.r.row(2 * y + 2) + 1;
        float* b = coarse.b.row(y);
        SAHEL_VECTORIZE
        for (int32_t x = 0; x < coarse.b.nx; ++x) {
            const int32_t i = 2 * x;
            const float sides = (here[i - 1] + here[i + 1]) + (up[i] + down[i]);
            const float corners = (up[i - 1] + down[i + 1]) + (up[i + 1] + down[i - 1]);
            b[x] = here[i] + 0.5f * sides + 0.25f * corners;
        }
    });
}

// e of the fine grid += bilinear e of the coarse one, or that times the checkerboard.
void prolong(const ProjectLevel& coarse, const ProjectLevel& fine, bool checkered) {
    coarse.e.fill_ring(coarse.ring_x, coarse.ring_y);
    for_each_row(k_name, fine.e.nx, fine.e.ny, [&](int32_t y) {
        // Corner 2 Y + 1 of the fine grid is corner Y of the coarse one.
        const float* a = coarse.e.row(y % 2 != 0 ? y / 2 : y / 2 - 1);
        const float* b = coarse.e.row(y / 2);
        float* e = fine.e.row(y);
        const float even = checkered && y % 2 != 0 ? -0.25f : 0.25f;
        const float odd = checkered ? -2.0f * even : 0.5f;
        const int32_t pairs = fine.e.nx / 2;
        SAHEL_VECTORIZE
        for (int32_t x = 0; x < pairs; ++x) {
            const float left = a[x - 1] + b[x - 1];
            const float right = a[x] + b[x];
            e[2 * x] += even * (left + right);
            e[2 * x + 1] += odd * right;
        }
        if (fine.e.nx % 2 != 0) e[2 * pairs] += even * ((a[pairs - 1] + b[pairs - 1]) + (a[pairs] + b[pairs]));
    });
}

void find_residual(const ProjectLevel& l) {
    l.e.fill_ring(l.ring_x, l.ring_y);
    for_each_row(k_name, l.e.nx, l.e.ny, [&](int32_t y) {
        const float* up = l.e.row(y - 1);
        const float* here = l.e.row(y);
        const float* down = l.e.row(y + 1);
        const float* b = l.b.row(y);
        float* r = l.r.row(y);
        SAHEL_VECTORIZE
        for (int32_t x = 0; x < l.e.nx; ++x) r[x] = b[x] - five_point(up, here, down, x);
    });
}

// levels[first].e = one V-cycle for levels[first].b.
void cycle(const ProjectWork& w, int32_t first) {
    const int32_t last = w.level_count - 1;
    for (int32_t i = first; i < last; ++i) {
        chebyshev(w.levels[i], k_smooth_low, k_smooth_steps, true, true);
        restrict_residual(w.levels[i], w.levels[i + 1]);
    }
    chebyshev(w.levels[last], w.coarsest_low, w.coarsest_steps, true, false);
    for (int32_t i = last - 1; i >= first; --i) {
        prolong(w.levels[i + 1], w.levels[i], false);
        find_residual(w.levels[i]);
        chebyshev(w.levels[i], k_smooth_low, k_smooth_steps, false, false);
    }
}

// levels[0].e = the preconditioned levels[0].b: a V-cycle, and one from the second level on for what is smooth but for
// a checkerboard.
void precondition(const ProjectWork& w) {
    cycle(w, 0);
    if (w.level_count < 2) return;
    const ProjectLevel& l = w.levels[0];
    for_each_row(k_name, l.b.nx, l.b.ny, [&](int32_t y) {
        const float* b = l.b.row(y);
        float* r = l.r.row(y);
        const float sign = y % 2 != 0 ? -1.0f : 1.0f;
        for (int32_t x = 0; x < l.b.nx; ++x) r[x] = (x % 2 != 0 ? -sign : sign) * b[x];
    });
    restrict_residual(l, w.levels[1]);
    cycle(w, 1);
    prolong(w.levels[1], l, true);
}

// Corner (x, y) lies between cells (x, y) and (x + 1, y + 1).
void minus_divergence(const ProjectWork& w, const WindPlane& out) {
    for_each_row(k_name, out.nx, out.ny, [&](int32_t y) {
        const float* ux = w.wind_x.row(y);
        const float* lx = w.wind_x.row(y + 1);
        const float* uy = w.wind_y.row(y);
        const float* ly = w.wind_y.row(y + 1);
        float* o = out.row(y);
        SAHEL_VECTORIZE
        for (int32_t x = 0; x < out.nx; ++x) {
            const float across = (ux[x] + lx[x]) - (ux[x + 1] + lx[x + 1]);
            const float along = (uy[x] + uy[x + 1]) - (ly[x] + ly[x + 1]);
            o[x] = 0.5f * across + 0.5f * along;
        }
    });
}

void subtract_gradient(const ProjectWork& w) {
    w.q.fill_ring(w.levels[0].ring_x, w.levels[0].ring_y);
    for_each_row(k_name, w.wind_x.nx, w.wind_x.ny, [&](int32_t y) {
        const float* up = w.q.row(y - 1);
        const float* down = w.q.row(y);
        float* ox = w.wind_x.row(y);
        float* oy = w.wind_y.row(y);
        SAHEL_VECTORIZE
        for (int32_t x = 0; x < w.wind_x.nx; ++x) {
            ox[x] -= 0.5f * ((up[x] + down[x]) - (up[x - 1] + down[x - 1]));
            oy[x] -= 0.5f * ((down[x - 1] + down[x]) - (up[x - 1] + up[x]));
        }
    });
    w.wind_x.fill_ring(w.ring_x, w.ring_y);
    w.wind_y.fill_ring(w.ring_x, w.ring_y);
}

// ad = A d, with rings: -div grad couples the four diagonal neighbours.
void apply(const ProjectWork& w) {
    w.d.fill_ring(w.levels[0].ring_x, w.levels[0].ring_y);
    for_each_row(k_name, w.d.nx, w.d.ny, [&](int32_t y) {
        const float* up = w.d.row(y - 1);
        const float* here = w.d.row(y);
        const float* down = w.d.row(y + 1);
        float* o = w.ad.row(y);
        SAHEL_VECTORIZE
        for (int32_t x = 0; x < w.d.nx; ++x)
            o[x] = 2.0f * here[x] - 0.5f * ((up[x - 1] + down[x + 1]) + (up[x + 1] + down[x - 1]));
    });
}

} // namespace

void run_project_wind(ProjectWork& w) {
    const WindPlane& r = w.levels[0].b;
    const WindPlane& z = w.levels[0].e;
    minus_divergence(w, r);
    w.before = largest(r, w.row_sums);
    w.after = w.before;
    w.iterations = 0;
    if (!(w.before > 0.0f)) return;
    const float enough = w.tolerance * w.before;
    precondition(w);
    for (int32_t y = 0; y < r.ny; ++y)
        for (int32_t x = 0; x < r.nx; ++x) {
            w.q.row(y)[x] = 0.0f;
            w.d.row(y)[x] = z.row(y)[x];
        }
    double rz = dot(r, z, w.row_sums);
    while (w.iterations < w.most_iterations && rz > 0.0) {
        apply(w);
        const double curvature = dot(w.d, w.ad, w.row_sums);
        if (!(curvature > 0.0)) break;
        const auto step = static_cast<float>(rz / curvature);
        for_each_row(k_name, r.nx, r.ny, [&](int32_t y) {
            const float* d = w.d.row(y);
            const float* ad = w.ad.row(y);
            float* q = w.q.row(y);
            float* rest = r.row(y);
            SAHEL_VECTORIZE
            for (int32_t x = 0; x < r.nx; ++x) {
                q[x] += step * d[x];
                rest[x] -= step * ad[x];
            }
        });
        w.iterations += 1;
        if (largest(r, w.row_sums) <= enough) break;
        precondition(w);
        const double rz_next = dot(r, z, w.row_sums);
        const auto keep = static_cast<float>(rz_next / rz);
        rz = rz_next;
        for_each_row(k_name, r.nx, r.ny, [&](int32_t y) {
            const float* from = z.row(y);
            float* d = w.d.row(y);
            SAHEL_VECTORIZE
            for (int32_t x = 0; x < r.nx; ++x) d[x] = from[x] + keep * d[x];
        });
    }
    subtract_gradient(w);
    minus_divergence(w, w.ad);
    w.after = largest(w.ad, w.row_sums);
}

} // namespace sahel::SAHEL_ISA_NAMESPACE
