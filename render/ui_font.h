#pragma once

#include <string>

/// The typeface of panels and captions.
namespace sahel {

/// A sans-serif font file of the distribution (SAHEL_FONT names another); empty where there is none, and ImGui's own
/// bitmap font serves.
std::string ui_font_file();

} // namespace sahel
