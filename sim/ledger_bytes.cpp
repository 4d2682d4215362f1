#include "sim/ledger.h"

#include <fmt/format.h>

/// Layout: version, number of layers, number of sources; then every number of every layer in the order of LayerAccount,
/// zigzag (small numbers of either sign are small) in groups of seven bits; a run of zeros is a zero and its length.
namespace sahel {

namespace {

constexpr uint8_t k_version = 1;

template <class Account, class F> void for_each_number(Account& account, size_t sources, F&& f) {
    f(account.opening);
    f(account.closing);
    for (size_t i = 0; i < sources; ++i) f(account.sources[i]);
    for (auto* borders : {&account.exchanged, &account.to_frozen, &account.to_open})
        for (auto& ticks : *borders) f(ticks);
}

void put(std::vector<uint8_t>& bytes, uint64_t v) {
    for (; v >= 0x80; v >>= 7) bytes.push_back(static_cast<uint8_t>(v | 0x80));
    bytes.push_back(static_cast<uint8_t>(v));
}

bool take(std::span<const uint8_t>& bytes, uint64_t& v) {
    v = 0;
    for (int shift = 0; shift < 70; shift += 7) {
        if (bytes.empty()) return false;
        const uint8_t b = bytes.front();
        bytes = bytes.subspan(1);
        if (shift == 63 && b > 1) return false;
        v |= static_cast<uint64_t>(b & 0x7F) << shift;
        if ((b & 0x80) == 0) return b != 0 || shift == 0; // one way to write a number
    }
    return false;
}

} // namespace

std::vector<uint8_t> ledger_bytes(const TileAccount& account) {
    std::vector<uint8_t> bytes = {k_version, k_conserved_count, k_ledger_source_count};
    uint64_t zeros = 0;
    const auto flush = [&] {
        if (zeros == 0) return;
        bytes.push_back(0);
        put(bytes, zeros);
        zeros = 0;
    };
    for (const LayerAccount& layer : account.layers)
        for_each_number(layer, k_ledger_source_count, [&](const int64_t& ticks) {
            if (ticks == 0) {
                ++zeros;
                return;
            }
            flush();
            put(bytes, (static_cast<uint64_t>(ticks) << 1) ^ static_cast<uint64_t>(ticks >> 63));
        });
    flush();
    return bytes;
}

Result<TileAccount> parse_ledger_bytes(TileKey key, std::span<const uint8_t> bytes, std::string_view name) {
    const Error corrupt{ErrorKind::corrupt,
                        fmt::format("{}: the account of tile {},{} is damaged", name, key.x, key.y)};
    if (bytes.size() < 3) return corrupt;
    if (bytes[0] > k_version || bytes[1] > k_conserved_count || bytes[2] > k_ledger_source_count)
        return Error{ErrorKind::unsupported,
                     fmt::format("{}: the account of tile {},{} was written by a newer program; use a newer sahel",
                                 name, key.x, key.y)};
    if (bytes[0] == 0) return corrupt;
    TileAccount account{key, {}};
    const size_t layers = bytes[1];
    const size_t sources = bytes[2];
    bytes = bytes.subspan(3);
    uint64_t zeros = 0;
    bool good = true;
    for (size_t i = 0; i < layers; ++i)
        for_each_number(account.layers[i], sources, [&](int64_t& ticks) {
            if (!good) return;
            if (zeros == 0) {
                uint64_t v = 0;
                good = take(bytes, v);
                if (v != 0) {
                    ticks = static_cast<int64_t>(v >> 1) ^ -static_cast<int64_t>(v & 1);
                    return;
                }
                good = good && take(bytes, zeros) && zeros > 0;
                if (!good) return;
            }
            --zeros;
        });
    if (!good || zeros != 0 || !bytes.empty()) return corrupt;
    return account;
}

} // namespace sahel
