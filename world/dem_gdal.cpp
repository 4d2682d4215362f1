#include "world/dem_gdal.h"

#include <algorithm>
#include <mutex>

namespace sahel {

void gdal_start(uint64_t cache_bytes) {
    static std::once_flag once;
    std::call_once(once, [] { GDALAllRegister(); });
    GDALSetCacheMax64(static_cast<GIntBig>(cache_bytes));
}

GdalScope::GdalScope() {
    CPLPushErrorHandlerEx(&GdalScope::handle, this);
}
GdalScope::~GdalScope() {
    CPLPopErrorHandler();
}

void GdalScope::handle(CPLErr kind, CPLErrorNum, const char* text) {
    auto* self = static_cast<GdalScope*>(CPLGetErrorHandlerUserData());
    if (!self || kind < CE_Warning) return;
    std::string line = text ? text : "";
    std::replace(line.begin(), line.end(), '\n', ' ');
    (kind == CE_Warning ? self->warning_ : self->error_) = std::move(line);
}

std::string GdalScope::message(const std::string& otherwise) const {
    if (!error_.empty()) return error_;
    return warning_.empty() ? otherwise : warning_;
}

bool gdal_crs(const std::string& text, OGRSpatialReference& crs) {
    if (text.empty() || crs.SetFromUserInput(text.c_str()) != OGRERR_NONE) return false;
    if (crs.IsCompound()) crs.StripVertical();
    crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    return true;
}

} // namespace sahel
