#include "widgets/desk/selection.h"

namespace seamwright {

void Selection::select_spot(const std::string& id) {
    if (id == spot_) return;
    spot_ = id;
    emit changed();
}
void Selection::select_region(const std::string& id) {
    if (id == region_) return;
    region_ = id;
    emit changed();
}
void Selection::select_sensor(const std::string& id) {
    if (id == sensor_) return;
    sensor_ = id;
    emit changed();
}
void Selection::select_part_type(const std::string& id) {
    if (id == part_type_) return;
    part_type_ = id;
    emit changed();
}

}  // namespace seamwright
