#include "world/exr_tile.h"

#include <fmt/format.h>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIntAttribute.h>
#include <ImfIO.h>
#include <ImfStringAttribute.h>
#include <ImfTiledInputFile.h>
#include <ImfTiledOutputFile.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <exception>

namespace sahel {

namespace {

constexpr int k_exr_tile = 256; // pixels of an EXR tile: a window of a large tile reads only what it touches

class MemoryOut final : public Imf::OStream {
  public:
    MemoryOut() : Imf::OStream("tile") {}
    void write(const char c[], int n) override {
        if (at_ + static_cast<uint64_t>(n) > bytes.size()) bytes.resize(at_ + static_cast<uint64_t>(n));
        std::memcpy(bytes.data() + at_, c, static_cast<size_t>(n));
        at_ += static_cast<uint64_t>(n);
    }
    uint64_t tellp() override { return at_; }
    void seekp(uint64_t pos) override { at_ = pos; }
    std::vector<uint8_t> bytes;

  private:
    uint64_t at_ = 0;
};

class MemoryIn final : public Imf::IStream {
  public:
    MemoryIn(std::span<const uint8_t> bytes, const char* name) : Imf::IStream(name), bytes_(bytes) {}
    bool read(char c[], int n) override {
        if (n < 0 || at_ + static_cast<uint64_t>(n) > bytes_.size())
            throw std::runtime_error("the file ends too early");
        std::memcpy(c, bytes_.data() + at_, static_cast<size_t>(n));
        at_ += static_cast<uint64_t>(n);
        return at_ < bytes_.size();
    }
    uint64_t tellg() override { return at_; }
    void seekg(uint64_t pos) override { at_ = std::min<uint64_t>(pos, bytes_.size()); }

  private:
    std::span<const uint8_t> bytes_;
    uint64_t at_ = 0;
};

bool whole_number(const std::string& text, int64_t& value) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size();
}

/// Whether programs may add up the four materials of every cell, in this order, in int32.
bool surface_fits(const StoredTile& tile) {
    if (k_surface_layers.intersected(tile.varying).empty()) { // one value everywhere
        int64_t sum = 0;
        bool fits = true;
        k_surface_layers.for_each([&](Layer layer) {
            sum += tile.constant[static_cast<size_t>(layer)];
            fits = fits && sum == static_cast<int32_t>(sum);
        });
        return fits;
    }
    const auto n = static_cast<size_t>(tile.tile_cells);
    std::vector<int64_t> sum(n);
    std::vector<int32_t> row(n);
    int64_t low = 0, high = 0;
    for (int y = 0; y < tile.tile_cells; ++y) {
        std::fill(sum.begin(), sum.end(), 0);
        k_surface_layers.for_each([&](Layer layer) {
            tile.copy_row(layer, 0, y, tile.tile_cells, row.data());
            for (size_t x = 0; x < n; ++x) {
                sum[x] += row[x];
                low = std::min(low, sum[x]);
                high = std::max(high, sum[x]);
            }
        });
    }
    return low >= INT32_MIN && high <= INT32_MAX;
}

Imf::Compression exr_compression(TileCompression c) {
    switch (c) {
    case TileCompression::none:
        return Imf::NO_COMPRESSION;
    case TileCompression::zips:
        return Imf::ZIPS_COMPRESSION;
    case TileCompression::zip:
        return Imf::ZIP_COMPRESSION;
    case TileCompression::piz:
        return Imf::PIZ_COMPRESSION;
    }
    return Imf::NO_COMPRESSION;
}

std::string constant_name(Layer layer) {
    return "sahel_constant_" + std::string(info_of(layer).name);
}

/// A layer's column as raw bits, whatever its type.
int32_t* column(LayerBlock& block, Layer layer) {
    return info_of(layer).type == LayerType::real ? reinterpret_cast<int32_t*>(block.reals(layer).origin)
                                                  : block.ints(layer).origin;
}
const int32_t* column(const LayerBlock& block, Layer layer) {
    return column(const_cast<LayerBlock&>(block), layer);
}
int64_t stride_of(const LayerBlock& block, Layer layer) {
    return info_of(layer).type == LayerType::real ? block.reals(layer).stride : block.ints(layer).stride;
}

} // namespace

int32_t StoredTile::at(Layer layer, int x, int y) const {
    if (!varying.contains(layer)) return constant[static_cast<size_t>(layer)];
    return column(block, layer)[y * stride_of(block, layer) + x];
}

void StoredTile::copy_row(Layer layer, int x0, int y, int count, int32_t* to) const {
    if (varying.contains(layer))
        std::memcpy(to, column(block, layer) + y * stride_of(block, layer) + x0, static_cast<size_t>(count) * 4);
    else
        std::fill_n(to, count, constant[static_cast<size_t>(layer)]);
}

Result<StoredTile> make_stored_tile(TileKey key, int tile_cells, const LayerBlock& from, MemoryPool& pool) {
    StoredTile tile;
    tile.key = key;
    tile.tile_cells = tile_cells;
    SAHEL_CHECK(from.owned() == tile_rect(key, tile_cells));
    const LayerSet given = from.layers().intersected(k_stored_layers);
    given.for_each([&](Layer layer) {
        const int32_t* c = column(from, layer);
        const int64_t stride = stride_of(from, layer);
        const int32_t first = c[0];
        for (int y = 0; y < tile_cells; ++y)
            for (int x = 0; x < tile_cells; ++x)
                if (c[y * stride + x] != first) {
                    tile.varying.insert(layer);
                    return;
                }
        tile.constant[static_cast<size_t>(layer)] = first;
    });
    if (tile.varying.empty()) return tile;
    SAHEL_ASSIGN(tile.block, LayerBlock::allocate(key.level, from.owned(), 0, tile.varying, pool));
    tile.varying.for_each([&](Layer layer) {
        for (int y = 0; y < tile_cells; ++y)
            std::memcpy(column(tile.block, layer) + y * stride_of(tile.block, layer),
                        column(from, layer) + y * stride_of(from, layer), static_cast<size_t>(tile_cells) * 4);
    });
    return tile;
}

Result<std::vector<uint8_t>> encode_tile(const StoredTile& tile, TileCompression compression) {
    if (!surface_fits(tile))
        return Error{ErrorKind::usage,
                     fmt::format("tile {},{},{}: heights beyond +-16 km", tile.key.level, tile.key.x, tile.key.y)};
    try {
        const int n = tile.tile_cells;
        Imf::Header header(n, n);
        header.compression() = exr_compression(compression);
        header.setTileDescription(
            Imf::TileDescription(std::min(n, k_exr_tile), std::min(n, k_exr_tile), Imf::ONE_LEVEL));
        header.insert("sahel_version", Imf::IntAttribute(k_tile_format_version));
        header.insert("sahel_level", Imf::IntAttribute(tile.key.level));
        header.insert("sahel_x", Imf::StringAttribute(std::to_string(tile.key.x)));
        header.insert("sahel_y", Imf::StringAttribute(std::to_string(tile.key.y)));
        Imf::FrameBuffer frame;
        k_stored_layers.for_each([&](Layer layer) {
            if (!tile.varying.contains(layer)) {
                const int32_t value = tile.constant[static_cast<size_t>(layer)];
                if (info_of(layer).role == LayerRole::state || value != 0)
                    header.insert(constant_name(layer), Imf::IntAttribute(value));
                return;
            }
            const std::string name(info_of(layer).name);
            const Imf::PixelType type = info_of(layer).type == LayerType::real ? Imf::FLOAT : Imf::UINT;
            header.channels().insert(name, Imf::Channel(type));
            frame.insert(name,
                         Imf::Slice(type, reinterpret_cast<char*>(const_cast<int32_t*>(column(tile.block, layer))), 4,
                                    static_cast<size_t>(stride_of(tile.block, layer)) * 4));
        });
        std::vector<float> surface(static_cast<size_t>(n) * static_cast<size_t>(n));
        for (int y = 0; y < n; ++y)
            for (int x = 0; x < n; ++x)
                surface[static_cast<size_t>(y) * static_cast<size_t>(n) + static_cast<size_t>(x)] =
                    metres_of_ticks(tile.at(Layer::bedrock, x, y) + tile.at(Layer::soil, x, y) +
                                    tile.at(Layer::sand, x, y) + tile.at(Layer::water, x, y));
        header.channels().insert("Y", Imf::Channel(Imf::FLOAT));
        frame.insert("Y",
                     Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(surface.data()), 4, static_cast<size_t>(n) * 4));
        MemoryOut out;
        {
            Imf::TiledOutputFile file(out, header);
            file.setFrameBuffer(frame);
            file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
        }
        return std::move(out.bytes);
    } catch (const std::exception& e) {
        return Error{ErrorKind::io,
                     fmt::format("tile {},{},{}: OpenEXR: {}", tile.key.level, tile.key.x, tile.key.y, e.what())};
    }
}

Result<StoredTile> decode_tile(std::span<const uint8_t> bytes, const std::string& name, MemoryPool& pool) {
    const auto corrupt = [&](const std::string& why) {
        return Error{ErrorKind::corrupt, fmt::format("{}: {}", name, why)};
    };
    try {
        MemoryIn in(bytes, name.c_str());
        Imf::TiledInputFile file(in);
        const Imf::Header& header = file.header();
        const auto* version = header.findTypedAttribute<Imf::IntAttribute>("sahel_version");
        if (!version) return corrupt("not a tile of a world");
        if (version->value() > k_tile_format_version)
            return Error{ErrorKind::unsupported,
                         fmt::format("{}: tile format {} is newer than this program's {}; use a newer "
                                     "sahel",
                                     name, version->value(), k_tile_format_version)};
        const auto* level = header.findTypedAttribute<Imf::IntAttribute>("sahel_level");
        const auto* x = header.findTypedAttribute<Imf::StringAttribute>("sahel_x");
        const auto* y = header.findTypedAttribute<Imf::StringAttribute>("sahel_y");
        if (!level || !x || !y) return corrupt("its place in the world is missing");
        const Imath::Box2i window = header.dataWindow();
        if (window.min != Imath::V2i(0, 0) || window.max.y != window.max.x || window.max.x < 0 || window.max.x >= 8192)
            return corrupt("not a square tile");
        const int n = window.max.x + 1;
        StoredTile tile;
        tile.key.level = level->value();
        if (!whole_number(x->value(), tile.key.x) || !whole_number(y->value(), tile.key.y) || !is_storable(tile.key))
            return corrupt("its place in the world cannot be");
        tile.tile_cells = n;
        std::string problem;
        k_stored_layers.for_each([&](Layer layer) {
            const std::string channel(info_of(layer).name);
            const Imf::PixelType type = info_of(layer).type == LayerType::real ? Imf::FLOAT : Imf::UINT;
            if (const Imf::Channel* c = header.channels().findChannel(channel)) {
                if (c->type != type || c->xSampling != 1 || c->ySampling != 1)
                    problem = "channel " + channel + " has the wrong type";
                tile.varying.insert(layer);
            } else if (const auto* constant = header.findTypedAttribute<Imf::IntAttribute>(constant_name(layer))) {
                tile.constant[static_cast<size_t>(layer)] = constant->value();
            } else if (info_of(layer).role == LayerRole::state) { // a shown layer may lack: zero
                problem = "layer " + channel + " is missing";
            }
        });
        if (!problem.empty()) return corrupt(problem);
        if (!tile.varying.empty()) {
            // No compression makes more than this of a byte: a few bytes must not ask for gigabytes.
            constexpr uint64_t k_most_per_byte = 16384;
            if (LayerBlock::bytes_needed(tile_rect(tile.key, n), 0, tile.varying) / k_most_per_byte > bytes.size())
                return corrupt("too short for its cells");
            SAHEL_ASSIGN(tile.block,
                         LayerBlock::allocate(tile.key.level, tile_rect(tile.key, n), 0, tile.varying, pool));
            Imf::FrameBuffer frame;
            tile.varying.for_each([&](Layer layer) {
                const Imf::PixelType type = info_of(layer).type == LayerType::real ? Imf::FLOAT : Imf::UINT;
                frame.insert(std::string(info_of(layer).name),
                             Imf::Slice(type, reinterpret_cast<char*>(column(tile.block, layer)), 4,
                                        static_cast<size_t>(stride_of(tile.block, layer)) * 4));
            });
            file.setFrameBuffer(frame);
            file.readTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
        }
        if (!surface_fits(tile)) return corrupt("heights beyond +-16 km");
        return tile;
    } catch (const std::exception& e) {
        return corrupt(e.what());
    }
}

} // namespace sahel
