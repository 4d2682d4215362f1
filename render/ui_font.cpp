#include "render/ui_font.h"

#include <cstdlib>
#include <filesystem>

namespace sahel {

std::string ui_font_file() {
    const auto there = [](const char* file) {
        std::error_code ignored;
        return std::filesystem::is_regular_file(file, ignored);
    };
    if (const char* named = std::getenv("SAHEL_FONT"); named && there(named)) return named;
    // Packages fonts-dejavu-core, fonts-liberation, fonts-noto-core, fonts-freefont-ttf.
    for (const char* file :
         {"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
          "/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf",
          "/usr/share/fonts/truetype/liberation2/LiberationSans-Regular.ttf",
          "/usr/share/fonts/truetype/noto/NotoSans-Regular.ttf", "/usr/share/fonts/truetype/freefont/FreeSans.ttf"})
        if (there(file)) return file;
    return {};
}

} // namespace sahel
