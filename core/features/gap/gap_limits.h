#pragma once
// What a sheet of a gap's profile is measured by. Private to gap_sides.cpp and gap_panels.cpp.

namespace seamwright::gap {

inline constexpr double kNoiseGate = 4.2;  // sigma
inline constexpr double kGoesOn = 5;       // sigma
inline constexpr int kLeastGround = 3;     // points
inline constexpr int kEndPoints = 12;      // of a sheet, that tell where it goes on

}  // namespace seamwright::gap
