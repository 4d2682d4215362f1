#pragma once

#include "tools/experiments/plane.h"

/// Along which line do crests run? Measured from a height field, and expected from the winds.
namespace sahel::experiments {

struct CrestAngle {
    double angle_deg = 0.0; ///< of the crest line, 0 to 180, from +x towards +y
    double coherence = 0.0; ///< 1: all slopes face along one line; 0: they face everywhere
};

/// The weaker eigenvector of the structure tensor, the sum of g gT over all cells (of `mask`, if given), where the
/// gradient g is taken over two cells to each side. A level field has coherence 0.
CrestAngle crest_angle(const Plane& height_m, const CellMask* mask = nullptr);
/// The mean of lines: of their doubled angles, each with its coherence as weight.
CrestAngle mean_line(const std::vector<CrestAngle>& lines);

/// A wind of the theory: sand flux and the direction it blows to.
struct FluxWind {
    double flux = 1.0;
    double angle_deg = 0.0;
};

/// Crest orientations after the two modes of Courrech du Pont, Narteau and Gao (Geology 42, 2014), with the growth of
/// flux over a crest that is met at angle a by 1 + gamma |sin a|:
///   bed instability  maximises  sum Q_i (1 + gamma |sin(t_i - a)|) |sin(t_i - a)|
///   elongation       solves     sum Q_i (1 + gamma |sin(t_i - a)|) sin(t_i - a) = 0, with positive flux along a
struct TwoModes {
    double instability_deg = 0.0; ///< 0 to 180
    double elongation_deg = 0.0;  ///< 0 to 360
    double resultant_deg = 0.0;   ///< direction of the summed flux
    double resultant_share = 0.0; ///< its length over the sum of lengths
};
TwoModes two_modes(const std::vector<FluxWind>& winds, double gamma = 1.6);

} // namespace sahel::experiments
