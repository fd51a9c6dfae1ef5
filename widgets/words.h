#pragma once
// What the layers below say, for a person and in the chosen language: identifiers as files and flags spell
// them
// ("not_pushed", "window_x_min_mm") and the sentences that describe settings, drivers and kinds of feature.

#include <QString>
#include <string_view>

namespace seamwright {

// "not_pushed" -> "not pushed", "window_x_min_mm" -> "Window, x from". One that is not in the list (a
// camera's own feature) is shown with blanks for underscores.
QString shown_word(std::string_view identifier);
bool has_word(std::string_view identifier);

// The sentence in the language of the window; English where it has no translation.
QString shown_sentence(std::string_view english);

}  // namespace seamwright
