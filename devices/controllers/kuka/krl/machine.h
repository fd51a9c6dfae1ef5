#pragma once
// The KRL machine: loaded modules, their variables, and tasks that execute them. What is the controller's own
// (system variables, motions, EthernetKRL) it asks of a Host. Strict: what is not known, not initialised or
// not of the type is an error that ends the task, never a thing passed over.
//
// A task executes a statement at a time under the machine's lock, so two tasks interleave between statements
// as a controller's interpreters do.

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>
#include <vector>

#include "devices/controllers/kuka/krl/krl_tree.h"

namespace seamwright::krl {

class Task;

// Where a value stands: an element or a row of a variable, or a system variable.
struct Place {
    VariablePtr variable;
    std::size_t cell = 0;
    bool row = false;
    std::string component;
    std::string system;  // with '$'; then `variable` is empty
    std::vector<long> indices;
};

struct Argument {
    Value value;         // evaluated, unless it is a place that is not initialised
    bool given = false;  // false = left out
    std::optional<Place> place;
};

enum class Motion { lin, lin_rel, ptp };

// A TRIGGER that waits for its motion.
struct PathTrigger {
    double before_end_mm = 0;
    std::function<void()> act;
};

// The controller around the interpreter. Everything is called with the machine's lock held; what waits does
// so within Task::unlocked().
class Host {
  public:
    virtual ~Host() = default;
    // nullopt = there is no such variable; Error (KrlError) = it is not initialised.
    virtual std::optional<Value> system_value(Task& task, const Place& place) = 0;
    virtual bool set_system(Task& task, const Place& place, const Value& value) = 0;
    // nullopt = there is no such routine. A routine without a value answers an unset one.
    virtual std::optional<Value> call(Task& task, const std::string& name,
                                      std::vector<Argument>& arguments) = 0;
    virtual void move(Task& task, Motion motion, const Value& target, bool approximates,
                      std::vector<PathTrigger> triggers) = 0;
    virtual void pulse(Task& task, const Place& output, bool level, double seconds) = 0;
    virtual void wait_main_run(Task& task) = 0;  // the advance run stops until the motions are done
    virtual void wait_seconds(Task& task, double seconds) = 0;
    virtual void halt(Task& task) = 0;  // until the start key
    // Of an interrupt program. A controller that does not override them has no BRAKE and no RESUME.
    virtual void brake(Task& task);            // until the robot stands; its motions wait
    virtual void give_up_motions(Task& task);  // RESUME: those begun and those planned
    virtual void interrupt_ended(Task&) {}     // by its END: the motions go on
    virtual void told(const std::string& message) = 0;
};

class Machine {
  public:
    // Takes a module in, or replaces the one of that name; its variables begin anew. Error (KrlError).
    void load(const std::string& file_name, const std::string& text);
    std::recursive_mutex& mutex() { return mutex_; }

    // Precondition of all below: the lock is held.
    VariablePtr find(const std::string& name, const std::string& module) const;
    std::shared_ptr<const Routine> routine(const std::string& name, const std::string& module) const;
    // By name as a client or a test reads them: "SW_FRAME[3]", "SW_NAME[1,]", "SW_MOVE_TO.X".
    Value value(Host& host, const std::string& place);
    void set(Host& host, const std::string& place, const std::string& value);

  private:
    std::recursive_mutex mutex_;
    std::map<std::string, std::shared_ptr<const Module>> programs_, data_;
    std::map<std::string, std::map<std::string, VariablePtr>> variables_;  // of data lists, by module
};

enum class TaskKind { robot, submit, trigger };
enum class TaskEnd { finished, stopped, failed };

class Task {
  public:
    Task(Machine& machine, Host& host, TaskKind kind, std::stop_token stop);
    // Executes a program without parameters. `failure` says why it failed.
    TaskEnd run(const std::string& program, std::string& failure);
    TaskKind kind() const { return kind_; }
    const std::stop_token& stop() const { return stop_; }
    // Without the lock meanwhile; ends the task when it was stopped.
    void unlocked(const std::function<void()>& wait);
    // Until `over`, looking every few milliseconds; interrupts happen meanwhile.
    void wait(const std::function<bool()>& over);
    // Whether what is read or written now stops the advance run: not the event of an interrupt.
    bool stops_advance() const { return kind_ == TaskKind::robot && !watching_; }

    Value read(const Place& place);
    void write(const Place& place, const Value& value);
    Value evaluate(const Expression& e);
    Place place(const Expression& e);

  private:
    struct Locals {
        std::shared_ptr<const Routine> routine;
        std::map<std::string, VariablePtr> variables;
    };
    enum class Flow { next, exit, returned };
    Flow execute(const Block& block);
    Flow execute(const Statement& s);
    Flow loop(const Statement& s);
    bool condition(const ExpressionPtr& e);
    void simple(const Statement& s);
    void trigger(const Statement& s);
    Value call(const Expression& e, bool as_statement);
    Value invoke(const Routine& routine, std::vector<Argument>& arguments);
    std::vector<Argument> arguments_of(const Expression& e);
    Value aggregate(const Expression& e);
    Value binary(const Expression& e);
    [[noreturn]] void fail(const Statement& s, const std::string& why) const;
    void declare_interrupt(const Statement& s);
    void switch_interrupt(const Statement& s, bool on);
    void resume();
    void interrupts();
    void serve(int priority);
    void end_interrupts();  // local ones, with the program that declared them

    // Declared on a level, recognised there and below, GLOBAL above too. An event counts when it comes, not
    // while it lasts.
    struct Interrupt {
        bool global = false, on = false, was = false;
        std::size_t level = 0;
        std::string module;
        ExpressionPtr event, call;
    };
    struct Resumed {  // thrown by RESUME
        std::size_t level;
    };
    struct Serving {
        int priority = 0;
        std::size_t level = 0, interrupted = 0;  // where it was declared, and what it interrupts
    };
    Machine& machine_;
    Host& host_;
    const TaskKind kind_;
    const std::stop_token stop_;
    std::unique_lock<std::recursive_mutex> lock_;
    std::vector<Locals> stack_;
    std::vector<PathTrigger> triggers_;  // of the next motion
    Value returned_;
    std::map<int, Interrupt> interrupts_;  // by priority
    std::vector<Serving> serving_;
    bool watching_ = false;
};

}  // namespace seamwright::krl
