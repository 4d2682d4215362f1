#include "streaming/tile_streamer_impl.h"

#include <algorithm>
#include <cmath>

namespace sahel {

void TileStreamer::Impl::take_arrived() {
    if (!lockstep)
        mailbox->take(arrived);
    else if (awaited != 0)
        mailbox->take_one(arrived, awaited);
    for (Completion& c : arrived) {
        const uint32_t slot = c.slot;
        SAHEL_CHECK_EQ(pool.sequence[slot], c.sequence); // a load that began keeps its slot
        landed(c.sequence);
        pool.job[slot].reset();
        if (!c.result.ok()) {
            in_flight_bytes -= externals.max_payload_bytes;
            fail(slot, c.result.error().kind);
            continue;
        }
        pool.payload[slot] = std::move(c.result).value();
        SAHEL_CHECK(pool.payload[slot] != nullptr);
        SAHEL_CHECK_LE(pool.payload[slot]->bytes(), externals.max_payload_bytes);
        payload_bytes += pool.payload[slot]->bytes();
        if (!pool.reloading[slot]) pool.set_state(slot, NodeState::loaded);
        loaded_slots.push_back(slot);
    }
    arrived.clear();
}

void TileStreamer::Impl::fail(uint32_t slot, ErrorKind kind) {
    ++stats.failed_total;
    const bool for_good = kind == ErrorKind::usage || kind == ErrorKind::unsupported;
    const int attempts = for_good ? settings.max_attempts : pool.attempts[slot] + 1;
    pool.attempts[slot] = static_cast<uint8_t>(attempts);
    pool.retry_s[slot] = time_s + std::ldexp(static_cast<double>(settings.retry_after_s), std::min(attempts - 1, 6));
    if (pool.reloading[slot])
        pool.reloading[slot] = 0; // the old contents stay
    else
        pool.set_state(slot, attempts >= settings.max_attempts ? NodeState::failed : NodeState::retry_later);
}

void TileStreamer::Impl::publish(uint32_t slot) {
    TilePayload& payload = *pool.payload[slot];
    const uint64_t bytes = payload.bytes();
    externals.publish(pool.handle(slot), pool.key[slot], payload);
    std::shared_ptr<const TileContext> context = payload.context();
    if (context && externals.max_context_bytes > 0) SAHEL_CHECK_LE(context->bytes(), externals.max_context_bytes);
    pool.context[slot] = contexts.count(std::move(context));
    pool.low_m[slot] = payload.min_height_m();
    pool.high_m[slot] = payload.max_height_m();
    pool.epoch[slot] = pool.load_epoch[slot]; // older than wanted when it changed again meanwhile
    pool.attempts[slot] = 0;
    pool.payload[slot].reset();
    if (pool.reloading[slot]) {
        pool.reloading[slot] = 0;
    } else {
        pool.set_state(slot, NodeState::resident);
        pool.born_s[slot] = time_s;
    }
    payload_bytes -= bytes;
    in_flight_bytes -= externals.max_payload_bytes;
    ++stats.published;
    ++stats.published_total;
    stats.published_bytes += bytes;
}

void TileStreamer::Impl::publish_loaded() {
    // Wanted ones first, in the order of the wants; then the rest, oldest request first.
    std::sort(loaded_slots.begin(), loaded_slots.end(), [&](uint32_t a, uint32_t b) {
        const bool wa = wanted_now(a), wb = wanted_now(b);
        if (wa != wb) return wa;
        if (wa && pool.rank[a] != pool.rank[b]) return pool.rank[a] < pool.rank[b];
        return pool.sequence[a] < pool.sequence[b];
    });
    const double begin = externals.now_s ? externals.now_s() : 0.0;
    const uint64_t most_bytes = static_cast<uint64_t>(settings.publish_mib_per_frame) << 20;
    size_t taken = 0;
    while (taken < loaded_slots.size() && stats.published < settings.publishes_per_frame) {
        const uint32_t slot = loaded_slots[taken];
        if (stats.published_bytes + pool.payload[slot]->bytes() > most_bytes) break;
        publish(slot);
        ++taken;
        if (externals.now_s && (externals.now_s() - begin) * 1e3 >= static_cast<double>(settings.publish_ms_per_frame))
            break;
    }
    loaded_slots.erase(loaded_slots.begin(), loaded_slots.begin() + static_cast<std::ptrdiff_t>(taken));
}

void TileStreamer::Impl::landed(uint64_t sequence) {
    const auto found = std::find(in_flight.begin(), in_flight.end(), sequence);
    SAHEL_CHECK(found != in_flight.end());
    in_flight.erase(found);
}

/// Whether the worst that one more load can bring stays within the budgets.
bool TileStreamer::Impl::load_fits() const {
    return loads_in_flight() < settings.max_loads_in_flight &&
           in_flight_bytes + externals.max_payload_bytes <= static_cast<uint64_t>(settings.in_flight_mib) << 20;
}

bool TileStreamer::Impl::context_fits() const {
    if (externals.max_context_bytes == 0) return true;
    const auto coming = in_flight.size() + loaded_slots.size() + 1;
    return contexts.bytes() + coming * externals.max_context_bytes <= static_cast<uint64_t>(settings.context_mib) << 20;
}

void TileStreamer::Impl::start(uint32_t slot) {
    const uint64_t sequence = next_sequence++;
    const uint32_t parent = pool.parent[slot];
    pool.sequence[slot] = sequence;
    if (pool.state(slot) == NodeState::resident)
        pool.reloading[slot] = 1;
    else
        pool.set_state(slot, NodeState::loading);
    // Made from a parent that is about to change: good enough to be drawn, and to be made again after it.
    const bool passing = parent != k_no_slot && may_reload(parent);
    pool.load_epoch[slot] = passing ? 0 : pool.wanted_epoch[slot];
    in_flight_bytes += externals.max_payload_bytes;
    in_flight.push_back(sequence);
    if (recording) requests.push_back(pool.key[slot]);
    std::shared_ptr<const TileContext> context = parent == k_no_slot ? nullptr : pool.context[parent];
    const auto job = std::make_shared<LoadJob>();
    pool.job[slot] = job;
    externals.submit(
        [box = mailbox, job, slot, sequence, key = pool.key[slot], context = std::move(context)]() mutable {
            box->run(*job, slot, sequence, key, std::move(context));
        });
}

/// False when a budget is used up.
bool TileStreamer::Impl::start_some(bool reloads, int most) {
    for (const uint32_t slot : wanted_slots) {
        const uint32_t parent = pool.parent[slot];
        if (reloads) {
            const bool again =
                pool.is_resident(slot) && !pool.reloading[slot] && may_reload(slot) && time_s >= pool.retry_s[slot];
            if (!again || (parent != k_no_slot && may_reload(parent))) continue; // parents first
        } else if (pool.state(slot) != NodeState::queued || (parent != k_no_slot && !pool.is_resident(parent))) {
            continue; // a child needs its parent's context
        }
        if (most-- == 0) return true;
        if (!load_fits()) return false;
        while (!context_fits())
            if (!make_room(WantGroup::visible)) return false;
        start(slot);
        starts_since_reload = reloads ? 0 : starts_since_reload + 1;
    }
    return true;
}

void TileStreamer::Impl::start_loads() {
    // What is missing goes before what is out of date, but every fourth load is of the latter.
    constexpr int k_fresh_per_reload = 3;
    if (starts_since_reload >= k_fresh_per_reload && !start_some(true, 1)) return;
    if (start_some(false, settings.max_loads_in_flight)) start_some(true, settings.max_loads_in_flight);
}

} // namespace sahel
