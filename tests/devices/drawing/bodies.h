#pragma once
// Bodies of known measure as files.

#include <string>

namespace seamwright {

// A box with a corner at the origin, its edges rounded by round_mm (0: sharp). `unit`: "MM", "M", "INCH".
std::string box_step(double x_mm, double y_mm, double z_mm, double round_mm, const char* unit = "MM");
std::string cylinder_step(double radius_mm, double height_mm, const char* unit = "MM");
// A plate with rows x columns round holes.
std::string plate_step(int rows, int columns);
std::string box_iges(double x_mm, double y_mm, double z_mm, const char* unit = "MM");

}  // namespace seamwright
