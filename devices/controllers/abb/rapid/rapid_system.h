#pragma once
// The instruction set: heads of what the interpreter knows, as RAPID text, and what of it needs no robot.

#include "devices/controllers/abb/rapid/rapid_machine.h"

namespace seamwright::rapid {

// As in the instruction set's CONST errnum.
enum ErrorNumber {
    kErrExcrtymax = 1001,
    kErrWaitMaxtime,
    kErrAlrdycnt,
    kErrSockClosed,
    kErrSockTimeout,
    kErrSockAddrInuse,
    kErrSymAccess,
    kErrTaskname,
    kErrUdpucComm
};

const std::string& instruction_set_text();
// Strings, numbers, data by name, clocks, raw bytes.
std::map<std::string, Native> general_natives();

Value make_number(Task& task, double value);
Value make_truth(Task& task, bool value);
Value make_text(Task& task, std::string value);

}  // namespace seamwright::rapid
