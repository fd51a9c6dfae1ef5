#pragma once
// Runs a URScript program in the controller's cycles.
//
// In a cycle every thread that does not wait runs, one after the other in an order that nobody may rely on,
// until it uses the robot's time (sync(), sleep(), a move, a blocking popup, join) or its slice of the cycle
// is over; then the next one runs and it goes on in the next cycle. So it is interrupted anywhere but between
// enter_critical and exit_critical. Slices are drawn from `seed`.
//
// A fault of the program stops it and the robot, with the line: a value of another type than the variable's
// first, an index beyond the list, a number beyond 32 bits, a division by zero, a loop that uses no time, the
// robot's time used in a critical section, too many threads.

#include <optional>
#include <random>
#include <string>
#include <vector>

#include "devices/controllers/ur/script/builtins.h"
#include "devices/controllers/ur/script/program.h"
#include "devices/controllers/ur/script/robot.h"

namespace seamwright::urscript {

struct InterpreterSettings {
    std::uint64_t seed = 1;
    int least_slice = 100, most_slice = 2000;  // operations a thread runs in one cycle
};

class Interpreter {
  public:
    Interpreter(Program program, ScriptRobot& robot, const InterpreterSettings& settings = {});

    void cycle();  // between the robot's begin_cycle() and end_cycle()
    bool running() const { return !threads_.empty(); }
    void stop();  // somebody pressed stop
    const std::optional<Error>& error() const { return error_; }
    // A global of that name that has a value.
    const Value* global(const std::string& name) const;
    std::size_t threads() const { return threads_.size(); }

  private:
    struct Frame {
        int function = 0;
        std::size_t at = 0;
        std::vector<std::optional<Value>> locals;
    };
    struct Thread {
        int id = 0, parent = 0;
        std::vector<Frame> frames;
        std::vector<Value> stack;
        Wait wait;
        int critical = 0;
        int idle_operations = 0;  // since it used time
    };
    enum class Then { goes_on, waits, ended };

    bool ready(Thread& thread) const;
    void run(Thread& thread);
    Then step(Thread& thread);
    Then call_builtin(Thread& thread, int number);
    void call(Thread& thread, int function, int arguments);
    void run_thread(Thread& thread, int function);
    Then join_or_kill(Thread& thread, const Value& which, bool kills);
    Value list_of(std::vector<Value>& stack, std::size_t count);
    Value pose_of(std::vector<Value>& stack);
    void fault(const std::string& what);
    void store(std::optional<Value>& to, Value value, const std::string& name);
    void store_element(std::optional<Value>& in, const std::string& name, const Value& index, Value value);
    Value element(const Value& of, const Value& index);
    Value arithmetic(Code code, const Value& a, const Value& b);
    Value comparison(Code code, const Value& a, const Value& b);
    bool truth(const Value& value);
    std::optional<std::size_t> place(const Value& index, std::size_t size);
    void kill(int id);
    bool alive(int id) const;

    const Program program_;
    ScriptRobot& robot_;
    const InterpreterSettings settings_;
    std::mt19937_64 random_;
    std::vector<std::optional<Value>> globals_;
    std::vector<Thread> threads_;  // the first is the program itself
    int next_id_ = 1, line_ = 0;
    std::vector<Thread> born_;  // in this cycle
    std::optional<Error> error_;
    bool stopped_ = false;
};

}  // namespace seamwright::urscript
