#pragma once
// The parameters that a controller's own routines are called with. Error (KrlError) where one is missing, not
// of the type or not initialised.

#include <optional>
#include <string>
#include <vector>

#include "devices/controllers/kuka/krl/machine.h"

namespace seamwright::krl {

std::string text_of(const std::vector<Argument>& arguments, std::size_t i);
const Value& value_of(const std::vector<Argument>& arguments, std::size_t i, Type type);
void expect_count(const std::vector<Argument>& arguments, std::size_t n);
// The variable that a value goes into. EthernetKRL demands that it was initialised before.
const Place& place_of(const std::vector<Argument>& arguments, std::size_t i);

// Of a system variable that is an array: 1 to `most`.
int index_of(const Place& place, int most);

void expect_initmov(const std::vector<Argument>& arguments);  // of BAS(#INITMOV,0)
// What MsgQuit or MsgNotify says; nothing for another routine.
std::optional<std::string> message_of(const std::string& name, const std::vector<Argument>& arguments);

}  // namespace seamwright::krl
