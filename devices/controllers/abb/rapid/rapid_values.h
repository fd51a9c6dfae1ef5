#pragma once
// What a program computes with values.

#include <string>

#include "devices/controllers/abb/rapid/rapid_language.h"

namespace seamwright::rapid {

// Throws std::runtime_error with the reason (division by zero, a string too long).
Value apply_unary(const std::string& sign, const Value& a);
Value apply_binary(const std::string& sign, const Value& a, const Value& b);
bool same_value(const Value& a, const Value& b);
// Copies value by value, so that references into `target` stay.
void store(Value& target, const Value& from);

}  // namespace seamwright::rapid
