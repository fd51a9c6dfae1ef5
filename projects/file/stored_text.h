#pragma once
// How a Text is stored: with its pattern and what goes into it, so that it can be said in any language later.
//
//   {"text": "region {}: {:.3f} mm", "with": ["left", 0.25]}     a sentence of the program; without arguments no "with"
//   "words of a device"                                         what somebody else says; old files have nothing else
//
// In columns of text stands the same, a sentence as the JSON document and words as they are.

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/error.h"

namespace seamwright {

nlohmann::json text_json(const Text& text);
// Error: neither a string nor such an object, or a pattern that does not fit what goes into it.
Expected<Text> text_from_json(const nlohmann::json& json);

std::string stored_text(const Text& text);
// What is no stored sentence is somebody's words.
Text text_from_stored(std::string stored);

// A result that programs read has the English: {"reason": "..."}. What screens say in other languages stands
// beside it in "texts", by the same name; results of old files have the English alone.
void put_text(nlohmann::json& object, const char* name, const Text& text);
void put_texts(nlohmann::json& object, const char* name, const std::vector<Text>& texts);
Text text_in(const nlohmann::json& object, const char* name);
std::vector<Text> texts_in(const nlohmann::json& object, const char* name);

}  // namespace seamwright
