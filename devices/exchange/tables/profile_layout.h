#pragma once
// Profiles as sensors and their tools write them (point_table.h), read without being told how; what was
// understood is said in one sentence. What cannot be known from the file is asked for, never assumed.
//
// Columns. By name: x ("X", "x [mm]", "Position"), z ("Z", "Height", "Range"; y where there is no z), the
// number of the profile ("profile_index", "Profil-Nr.", "frame_id"; "Index", "Encoder" or "Timestamp" where it holds still over several
// points), intensity. Two columns of one title are asked for. Without names: two columns are x and z; three are x, y and z where y holds still, or
// index, x and z. Several profiles in one file: by that number, by blocks between blank or comment lines, or
// by a y that holds still over several points. Rows where x starts over and nothing numbers the profiles are refused. A header `x_mm,z_mm` is our own form and read by
// profile_csv.h.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "core/profile/profile.h"

namespace seamwright {

struct ProfileLayout {
    std::string unit;     // of lengths (core/profile/units.h); empty: as the header says, else millimetres
    std::string columns;  // "X,Z" or "1,3": x and z by name or by number from 1; empty: seen from the file
    std::vector<double> invalid;  // heights, as the file writes them, that stand for "no return"
    bool operator==(const ProfileLayout&) const = default;
};

struct ReadProfile {
    double number = 0;  // as the file numbers it, else its place
    Profile profile;    // millimetres
    // Third coordinate of points in space (also of those said to be in the robot's base); empty where it
    // holds still. Such points are no profile until somebody turns them into a sensor's frame.
    std::vector<double> y_mm;
};

struct ReadProfiles {
    std::vector<ReadProfile> profiles;  // at least one
    std::string understood;  // "text separated by semicolons, decimal comma, header in line 5: x = ..."
    bool unit_asked = true;  // neither the person nor the header named a unit
};

// `where` names the file in errors. Error (input), with the line where there is one: what parse_points()
// refuses; columns that cannot be told or are not there; coordinates beyond 1 km; a profile that comes back
// after another one; no point with a return at all; an unknown unit, also of a header where the person says none. Heights at a limit of
// 32 bits or of a float are no return (is_type_limit).
Expected<ReadProfiles> parse_profiles(std::string_view bytes, const std::string& where,
                                      const ProfileLayout& layout);
Expected<ReadProfiles> read_profiles(const std::filesystem::path& path, const ProfileLayout& layout);

// A name as it stands in a header: "X [um]" -> {"x", "um"}; "z_mm" -> {"z", "mm"}. `unit` is empty where none
// is named; angles have "deg" and "rad". What stands in brackets and is no unit that is known ("X [px]") is `unknown`.
struct ColumnName {
    std::string name;  // lower case, letters and digits only
    std::string unit;
    std::string unknown;
};
ColumnName column_name(std::string_view header);

}  // namespace seamwright
