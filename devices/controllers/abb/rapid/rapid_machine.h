#pragma once
// Executes linked tasks, each on a thread of its own, in real time: an instruction costs what it costs a
// controller (about 30 us), tasks interleave between instructions, interrupts of the path reach their trap
// some milliseconds late.
//
// Errors go as on a controller: to the error handler of the routine in which they happen; from there RETRY
// (as often as the system parameter NoOfRetry allows), TRYNEXT, RETURN, or RAISE to the handler of the
// caller. Without a handler, or within one, or when a handler ends otherwise, the system's error handler
// stops the task and leaves its sentence in messages().

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>

#include "devices/controllers/abb/rapid/rapid_linker.h"

namespace seamwright::rapid {

class Machine;
class Task;

// A run-time error. `number` is the ERRNO; 0 is one that no handler can treat.
struct RuntimeError {
    int number = 0;
    std::string what;
    const void* leaving = nullptr;  // the frame whose handler has raised it
    bool placed = false;            // `what` says where
};

struct Slot {
    Value own;
    Value* ref = nullptr;  // of arguments by reference
    bool present = true;
    Value& value() { return ref ? *ref : own; }
};

// The arguments of a call, by the parameters' names.
class Call {
  public:
    Call(const Routine& routine, std::vector<Slot>& slots) : routine_(routine), slots_(slots) {}
    bool has(std::string_view name) const;  // false also when the routine knows no such argument
    Value& operator[](std::string_view name) const { return at(name).value(); }
    double number(std::string_view name) const { return at(name).value().number; }
    const std::string& text(std::string_view name) const { return at(name).value().text; }

  private:
    Slot& at(std::string_view name) const;
    const Routine& routine_;
    std::vector<Slot>& slots_;
};

// What an instruction or function of the system does. Called with the machine's lock held.
using Native = std::function<Value(Task&, const Call&)>;

class Task {
  public:
    Task(Machine& machine, TaskProgram program, std::string entry, bool moves);
    ~Task();
    const std::string& name() const { return program_.name; }
    TaskProgram& program() { return program_; }
    Machine& machine() { return machine_; }
    bool running() const { return running_; }
    void start();
    void ask_to_stop() { thread_.request_stop(); }

    // For natives. wait_until() sleeps without the lock, serves interrupts, and answers whether `done` came
    // before the time was over; `done` is asked with the lock held, every `poll`.
    bool wait_until(const std::function<bool()>& done, std::chrono::duration<double> at_most,
                    std::chrono::duration<double> poll);
    void pause(double seconds);
    // Runs `work` without the lock; it must not take longer than some 50 ms.
    template <class Work>
    auto unlocked(Work work);
    [[noreturn]] static void raise(int number, const std::string& what) {
        throw RuntimeError{number, what, nullptr, false};
    }
    int connect(const Routine* trap);
    void disconnect(int interrupt) { traps_.erase(interrupt); }
    bool is_connected(int interrupt) const { return traps_.count(interrupt) > 0; }
    // From any thread: the trap of that interrupt runs when its time has come.
    void interrupt(int number);
    void stop_here(const std::string& why);  // Stop and EXIT: the task stands

  private:
    struct Frame;
    enum class Flow { next, give_back, trynext, retry };
    void run(const std::stop_token& stop);
    void call(const Routine& routine, std::vector<Slot> slots, Value* result);
    Value call_with(const Routine& routine, const std::vector<Argument>& arguments, Frame* frame);
    Flow block(const Block& b, Frame& frame);
    Flow statement(const Statement& s, Frame& frame);
    Flow guarded(const Statement& s, Frame& frame);
    void wait_for_condition(const Statement& s, Frame& frame);
    Flow loop_for(const Statement& s, Frame& frame);
    Value eval(const Expr& e, Frame* frame);
    Value* reference(const Expr& e, Frame* frame);
    void step();
    void serve_interrupts();

    friend class Machine;
    Machine& machine_;
    TaskProgram program_;
    const std::string entry_;
    const bool moves_;
    std::atomic<bool> running_ = false;
    std::stop_token stop_;
    int debt_us_ = 0, depth_ = 0, next_interrupt_ = 1, errno_ = 0;
    bool in_trap_ = false;
    std::map<int, const Routine*> traps_;
    std::mutex interrupts_mutex_;
    std::deque<std::pair<std::chrono::steady_clock::time_point, int>> interrupts_;
    std::uint64_t random_ = 88172645463325252u;
    std::jthread thread_;
};

class Machine {
  public:
    // May the motion task go on at this instant (motors on, running)?
    using MayMove = std::function<bool()>;
    Machine(InstructionSet set, std::map<std::string, Native> natives, MayMove may_move);
    ~Machine();

    // Throws LoadError.
    Task& add(const std::string& name, const std::vector<SourceText>& sources, const std::string& entry,
              bool moves);
    void start();
    void stop();  // and waits for the tasks

    std::mutex& mutex() { return mutex_; }
    Task* task(const std::string& folded_name);
    // Data of a task by "name" or "module.name"; nullptr when there are none. To be used with the lock held.
    Value* find(const std::string& task, const std::string& name);
    std::vector<std::string> messages() const;
    void log(std::string message);
    const Native& native(int number) const { return natives_.at(static_cast<std::size_t>(number)); }
    bool may_move() const { return may_move_(); }
    const Type* type(const std::string& name) const { return set_.types.at(name); }

  private:
    InstructionSet set_;
    std::vector<Native> natives_;
    MayMove may_move_;
    Persistents shared_;
    std::mutex mutex_;
    mutable std::mutex log_mutex_;
    std::vector<std::string> messages_;
    std::vector<std::unique_ptr<Task>> tasks_;
};

template <class Work>
auto Task::unlocked(Work work) {
    struct Relock {
        std::mutex& m;
        explicit Relock(std::mutex& mutex) : m(mutex) { m.unlock(); }
        ~Relock() { m.lock(); }
    } relock(machine_.mutex());
    return work();
}

}  // namespace seamwright::rapid
