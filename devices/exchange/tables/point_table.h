#pragma once
// Points as sensors and their tools write them: text of any separator, NumPy arrays, PLY and PCD. One table
// of columns for all of them; what the columns mean is decided in profile_layout.h.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"

namespace seamwright {

// In the head of the PLY and PCD files that `export` writes: lengths and frame of their points.
inline constexpr std::string_view kInBaseMark = "millimetres, robot base";

struct PointTable {
    std::vector<std::string> names;            // empty where the file names none
    std::vector<std::vector<double>> columns;  // NaN: an empty field
    std::vector<std::size_t>
        blocks;  // first row of each block of rows (blank or comment line between), [0] = 0
    std::vector<std::uint32_t> lines;  // of text: the line of each row, from 1
    bool in_base = false;              // PLY and PCD with kInBaseMark: no profile of any plane yet
    std::string understood;            // "text, separated by semicolons, decimal comma, header in line 5"
    std::size_t rows() const { return columns.empty() ? 0 : columns.front().size(); }
    // "line 12" or "point 12" of a row, for messages.
    std::string at(const std::string& where, std::size_t row) const;
};

// Text: separated by tabs, semicolons, commas, bars or blanks; a preamble, a header and a line of units before the numbers. A
// column that holds no number in any line is passed over (NaN). What stands before the first row and has a row's form is a row, so
// that a broken number is named and not taken for a header.
// By content: NumPy by its magic, PLY and PCD by their first words, else text. Error (input), naming file and
// line: nothing numeric in it, a row of another width, a field that is no number, decimal commas that cannot
// be told from the commas between columns, points that may be decimal points or part thousands, UTF-16, binary forms that are not read (big-endian, compressed),
// sizes that the file does not hold, more than `limit` points.
Expected<PointTable> parse_points(std::string_view bytes, const std::string& where, std::size_t limit);

// Of them: NumPy version 1 to 3, float and integer of 1 to 8 bytes, little-endian, C or Fortran order, shape
// (n, c), (c, n) with c = 2 or 3, or (profiles, n, c).
Expected<PointTable> parse_npy(std::string_view bytes, const std::string& where, std::size_t limit);
// The element "vertex" of an ascii or binary little-endian PLY, which must come first and hold no lists.
Expected<PointTable> parse_ply_points(std::string_view bytes, const std::string& where, std::size_t limit);
// PCD of DATA ascii or binary.
Expected<PointTable> parse_pcd_points(std::string_view bytes, const std::string& where, std::size_t limit);
Expected<PointTable> parse_text_points(std::string_view text, const std::string& where, std::size_t limit);

// How a text separates its fields, and whether its decimal sign is a comma.
struct TextForm {
    char separator = ',';  // ' ': blanks and tabs
    bool decimal_comma = false;
};
const char* words(char separator);  // "semicolons"
std::vector<std::string_view> text_fields(std::string_view line, char separator);
// A word or a sign that stands for a number that is not there: nothing, "nan", "inf", "null", "N/A", "1.#QNAN", dashes, stars.
bool is_no_return(std::string_view field);
// False: no number. NaN: is_no_return(). U+2212 is a minus, D an exponent (Fortran); thousands may be parted by no-break blanks or
// apostrophes, and by the other one of point and comma where a decimal sign follows.
bool text_number(std::string_view field, bool decimal_comma, double& value);

}  // namespace seamwright
