// INTERRUPT, BRAKE and RESUME of the KRL machine, as far as they need no controller.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "devices/controllers/kuka/krl/machine.h"

namespace seamwright::krl {
namespace {
constexpr std::size_t kMostInterrupts = 32, kMostInterruptsOn = 16;

// Priorities 3 and 40 to 80 are the system's; 3 is that of BASISTECH, which every program declares alike.
bool is_priority(long p) {
    return (p >= 1 && p <= 39) || (p >= 81 && p <= 128);
}
}  // namespace

void Task::declare_interrupt(const Statement& s) {
    const long priority = std::lround(evaluate(*s.value).as_number());
    if (!is_priority(priority)) throw KrlError(fmt::format("{} is no priority of an interrupt", priority));
    if (!s.third->parts.empty()) throw KrlError("an interrupt program with parameters is not known here");
    Interrupt i;
    i.global = s.global;
    i.level = stack_.size();
    i.module = stack_.back().routine->module;
    i.event = s.second;
    i.call = s.third;
    interrupts_[static_cast<int>(priority)] = std::move(i);
    if (interrupts_.size() > kMostInterrupts)
        throw KrlError(fmt::format("more than {} interrupts are declared", kMostInterrupts));
}

void Task::switch_interrupt(const Statement& s, bool on) {
    const long priority = std::lround(evaluate(*s.value).as_number());
    const auto it = interrupts_.find(static_cast<int>(priority));
    if (it == interrupts_.end()) throw KrlError(fmt::format("interrupt {} is not declared", priority));
    Interrupt& i = it->second;
    i.on = on;
    if (!on) return;
    if (std::count_if(interrupts_.begin(), interrupts_.end(), [](const auto& each) {
            return each.second.on;
        }) > static_cast<std::ptrdiff_t>(kMostInterruptsOn))
        throw KrlError(fmt::format("more than {} interrupts are on", kMostInterruptsOn));
    watching_ = true;
    i.was = evaluate(*i.event).truth();
    watching_ = false;
}

// Between two statements and while the program waits.
void Task::interrupts() {
    if (kind_ != TaskKind::robot || watching_) return;
    for (auto it = interrupts_.begin(); it != interrupts_.end(); ++it) {
        const int priority = it->first;
        if (!it->second.on || (!it->second.global && stack_.size() < it->second.level)) continue;
        if (!serving_.empty() && serving_.back().priority <= priority) return;
        watching_ = true;
        bool now = false;
        try {
            now = evaluate(*it->second.event).truth();
        } catch (...) {
            watching_ = false;
            throw;
        }
        watching_ = false;
        const bool came = now && !it->second.was;
        it->second.was = now;
        if (!came) continue;
        serve(priority);
        it = interrupts_.find(priority);
        if (it == interrupts_.end()) return;  // its program has declared anew; looked at with the next tick
    }
}

void Task::serve(int priority) {
    const Interrupt i = interrupts_.at(priority);
    serving_.push_back({priority, i.level, stack_.size()});
    try {
        if (const auto routine = machine_.routine(i.call->name, i.module)) {
            std::vector<Argument> none;
            (void)invoke(*routine, none);
        } else {
            std::vector<Argument> none;
            if (!host_.call(*this, i.call->name, none))
                throw KrlError(fmt::format("there is no program {}", i.call->name));
        }
    } catch (...) {
        serving_.pop_back();
        throw;
    }
    serving_.pop_back();
    host_.interrupt_ended(*this);
}

void Task::resume() {
    if (serving_.empty()) throw KrlError("RESUME stands in an interrupt program only");
    const Serving now = serving_.back();
    // Where the task is, there is the advance run.
    if (now.interrupted <= now.level)
        throw KrlError(
            "RESUME: the program that declared the interrupt was interrupted itself; what is given up must "
            "be a program that it calls");
    host_.give_up_motions(*this);
    throw Resumed{now.level};
}

void Task::end_interrupts() {
    std::erase_if(interrupts_,
                  [&](const auto& i) { return !i.second.global && i.second.level > stack_.size(); });
}

}  // namespace seamwright::krl
