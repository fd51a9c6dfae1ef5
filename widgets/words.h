#pragma once
// Identifiers of the layers below, as files and flags spell them ("not_pushed", "window_x_min_mm"), for a
// person and in the chosen language. Their sentences are Texts (shown_text.h).

#include <QString>
#include <string_view>

namespace seamwright {

// "not_pushed" -> "not pushed", "window_x_min_mm" -> "Window, x from". One that is not in the list (a
// camera's own feature) is shown with blanks for underscores.
QString shown_word(std::string_view identifier);
bool has_word(std::string_view identifier);

// A setting's name apart from the unit it ends with: "exposure_us" -> "Exposure", "µs"; no unit: empty.
struct ShownSetting {
    QString name, unit;
};
ShownSetting shown_setting(std::string_view identifier);

}  // namespace seamwright
