#include "world/exr_image.h"

#include "world/file_io.h"

#include <fmt/format.h>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/openexr.h>

#include <algorithm>
#include <exception>

namespace sahel {

namespace fs = std::filesystem;

namespace {

void quiet(exr_const_context_t, exr_result_t, const char*) {}

Error bad(ErrorKind kind, const fs::path& path, std::string what) {
    std::replace(what.begin(), what.end(), '\n', ' ');
    return {kind, fmt::format("{}: {}", path.string(), what)};
}

/// The header alone, by the C library: nothing is allocated for what a broken file claims.
Status check_header(const fs::path& path, ExrImage& image, int& x0, int& y0) {
    exr_context_initializer_t how = EXR_DEFAULT_CONTEXT_INITIALIZER;
    how.error_handler_fn = quiet;
    exr_context_t context = nullptr;
    const exr_result_t opened = exr_start_read(&context, path.c_str(), &how);
    if (opened != EXR_ERR_SUCCESS) {
        exr_finish(&context);
        return bad(ErrorKind::corrupt, path,
                   fmt::format("not an EXR file that can be read ({})", exr_get_default_error_message(opened)));
    }
    exr_attr_box2i_t window{};
    int32_t chunks = 0;
    int parts = 0;
    exr_storage_t storage = EXR_STORAGE_SCANLINE;
    exr_get_count(context, &parts);
    const bool ok = exr_get_data_window(context, 0, &window) == EXR_ERR_SUCCESS &&
                    exr_get_chunk_count(context, 0, &chunks) == EXR_ERR_SUCCESS &&
                    exr_get_storage(context, 0, &storage) == EXR_ERR_SUCCESS;
    exr_finish(&context);
    if (!ok) return bad(ErrorKind::corrupt, path, "its header is incomplete");
    if (parts != 1 || storage == EXR_STORAGE_DEEP_SCANLINE || storage == EXR_STORAGE_DEEP_TILED)
        return bad(ErrorKind::unsupported, path, "only plain pictures of one part are read");
    const int64_t width = int64_t{window.max.x} - window.min.x + 1;
    const int64_t height = int64_t{window.max.y} - window.min.y + 1;
    if (width <= 0 || height <= 0) return bad(ErrorKind::corrupt, path, "its data window is empty");
    if (width > k_exr_image_max_side || height > k_exr_image_max_side)
        return bad(ErrorKind::unsupported, path,
                   fmt::format("{} x {} pixels; at most {} a side", width, height, k_exr_image_max_side));
    std::error_code failed;
    const auto bytes = static_cast<int64_t>(fs::file_size(path, failed));
    if (failed || chunks <= 0 || int64_t{chunks} * 8 > bytes)
        return bad(ErrorKind::corrupt, path, "its header claims more than the file holds: broken or cut short");
    image.width = static_cast<int32_t>(width);
    image.height = static_cast<int32_t>(height);
    x0 = window.min.x;
    y0 = window.min.y;
    return {};
}

} // namespace

const std::vector<float>* ExrImage::find(std::string_view name) const {
    for (const ExrPlane& plane : planes)
        if (plane.name == name) return &plane.values;
    return nullptr;
}

Result<ExrImage> read_exr_image(const fs::path& path) {
    std::error_code failed;
    if (!fs::exists(path, failed)) return bad(ErrorKind::not_found, path, "no such file");
    ExrImage image;
    int x0 = 0;
    int y0 = 0;
    SAHEL_TRY(check_header(path, image, x0, y0));
    try {
        Imf::InputFile file(path.c_str());
        const Imf::ChannelList& channels = file.header().channels();
        const auto cells = static_cast<size_t>(image.width) * static_cast<size_t>(image.height);
        for (auto c = channels.begin(); c != channels.end(); ++c) {
            if (c.channel().xSampling != 1 || c.channel().ySampling != 1)
                return bad(ErrorKind::unsupported, path, fmt::format("channel {} is subsampled", c.name()));
            if (image.planes.size() == 16) return bad(ErrorKind::unsupported, path, "more than 16 channels");
            image.planes.push_back({c.name(), {}});
        }
        Imf::FrameBuffer frame;
        for (ExrPlane& plane : image.planes) {
            plane.values.resize(cells);
            frame.insert(plane.name, Imf::Slice::Make(Imf::FLOAT, plane.values.data(), Imath::V2i(x0, y0), image.width,
                                                      image.height, sizeof(float),
                                                      sizeof(float) * static_cast<size_t>(image.width)));
        }
        file.setFrameBuffer(frame);
        file.readPixels(y0, y0 + image.height - 1);
    } catch (const std::exception& e) {
        return bad(ErrorKind::corrupt, path, fmt::format("cannot be read: {}", e.what()));
    }
    return image;
}

Status write_exr_image(const fs::path& path, const ExrImage& image) {
    const auto cells = static_cast<size_t>(image.width) * static_cast<size_t>(image.height);
    if (image.planes.empty() || cells == 0) return bad(ErrorKind::usage, path, "a picture without planes or cells");
    for (const ExrPlane& plane : image.planes)
        if (plane.values.size() != cells)
            return bad(ErrorKind::usage, path, fmt::format("plane {} has not {} values", plane.name, cells));
    if (path.has_parent_path()) SAHEL_TRY(make_folder(path.parent_path()));
    const fs::path aside = aside_path(path);
    try {
        Imf::Header header(image.width, image.height);
        header.compression() = Imf::ZIP_COMPRESSION;
        Imf::FrameBuffer frame;
        for (const ExrPlane& plane : image.planes) {
            header.channels().insert(plane.name, Imf::Channel(Imf::FLOAT));
            frame.insert(plane.name,
                         Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(const_cast<float*>(plane.values.data())),
                                    sizeof(float), sizeof(float) * static_cast<size_t>(image.width)));
        }
        Imf::OutputFile file(aside.c_str(), header);
        file.setFrameBuffer(frame);
        file.writePixels(image.height);
    } catch (const std::exception& e) {
        std::error_code ignored;
        fs::remove(aside, ignored);
        return bad(ErrorKind::io, path, fmt::format("cannot be written: {}", e.what()));
    }
    return commit_aside_file(aside, path);
}

} // namespace sahel
