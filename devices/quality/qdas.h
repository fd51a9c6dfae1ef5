#pragma once
// Q-DAS ASCII transfer format: description and values in one file (*.dfq), a K-field a line.
//     K0100 characteristics        K1001, K1002 part number, name     K1081, K1082 machine (robot) number, name
//     K2001 characteristic number  K2002 name                         K2022 decimals
//     K2101 nominal                K2110, K2111 lower, upper limit    K2120, K2121 kind of limit (1: limit)
//     K2142 unit                   K2401, K2402 gauge (sensor) number, name
//     K0001 value                  K0002 attribute (0: valid)         K0004 time DD.MM.YYYY/HH:MM:SS
//     K0006 batch (rehang)         K0014 part id
// Windows-1252, CR LF, decimal points. What the code page does not hold becomes '?', control characters blanks;
// texts are cut at the lengths that the format allows.

#include <string>
#include <vector>

#include "core/acceptance/acceptance.h"

namespace seamwright {

struct QdasStudy {
    std::string part_number, part_name;
    std::string machine_number, machine_name;  // empty: not written
    std::string gauge_number, gauge_name;
    std::string characteristic_number, characteristic_name;
    double nominal_mm = 0, lower_mm = 0, upper_mm = 0;
    std::string unit = "mm";  // of nominal, limits and values
    int decimals = 4;
    std::vector<StudyValue> values;  // written in this order
};

std::string dfq_text(const QdasStudy& study);
// Several characteristics of one part, numbered from 1: part, machine and gauge are the first one's. Empty: no text.
std::string dfq_text(const std::vector<QdasStudy>& characteristics);

}  // namespace seamwright
