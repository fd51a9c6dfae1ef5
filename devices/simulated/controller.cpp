#include "devices/simulated/controller.h"

#include <utility>

namespace seamwright {

std::string_view to_string(ControllerFault fault) {
    switch (fault) {
        case ControllerFault::none:
            return "none";
        case ControllerFault::silent:
            return "silent";
        case ControllerFault::slow:
            return "slow";
        case ControllerFault::wrong_answer:
            return "wrong_answer";
        case ControllerFault::half_message:
            return "half_message";
        case ControllerFault::disconnect:
            return "disconnect";
        case ControllerFault::reject_write:
            return "reject_write";
        case ControllerFault::out_of_range:
            return "out_of_range";
    }
    return "none";
}

const std::vector<ControllerFault>& controller_faults() {
    static const std::vector<ControllerFault> faults = {
        ControllerFault::silent,       ControllerFault::slow,       ControllerFault::wrong_answer,
        ControllerFault::half_message, ControllerFault::disconnect, ControllerFault::reject_write,
        ControllerFault::out_of_range};
    return faults;
}

std::optional<ControllerFault> controller_fault_from(std::string_view name) {
    if (name == to_string(ControllerFault::none)) return ControllerFault::none;
    for (const ControllerFault fault : controller_faults())
        if (to_string(fault) == name) return fault;
    return std::nullopt;
}

void SimulatedController::press_start(const PartId& part, const PartTypeId& type) {
    const std::lock_guard lock(mutex_);
    start_ = Call{part.text(), type.text()};
}

std::optional<PartVerdict> SimulatedController::verdict() const {
    const std::lock_guard lock(mutex_);
    return verdict_;
}

std::optional<SimulatedController::Call> SimulatedController::take_start() {
    const std::lock_guard lock(mutex_);
    return std::exchange(start_, std::nullopt);
}

void SimulatedController::part_begins() {
    const std::lock_guard lock(mutex_);
    verdict_.reset();
    released_ = taken_ = false;
}

void SimulatedController::withdraw() {
    const std::lock_guard lock(mutex_);
    if (!taken_) released_ = false;
}

bool SimulatedController::take() {
    const std::lock_guard lock(mutex_);
    if (released_) taken_ = true;
    return taken_;
}

void SimulatedController::take_verdict(PartVerdict verdict) {
    const std::lock_guard lock(mutex_);
    verdict_ = verdict;
    taken_ = false;
    released_ = verdict == PartVerdict::corrected;
}

void SimulatedController::tell(bool released, bool taken, std::optional<PartVerdict> verdict) {
    const std::lock_guard lock(mutex_);
    released_ = released;
    taken_ = taken;
    verdict_ = verdict;
}

}  // namespace seamwright
