#pragma once
// What the languages have in common: values, statements as a tree, and the run through them that gathers points and notes.

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "devices/exchange/words/tokens.h"
#include "devices/robot_path/robot_path.h"

namespace seamwright::program_path {

// Numbers, truths, texts, and lists of values that may have names (records of KRL, named components of RAPID are by place).
struct Value {
    enum class Kind { unknown, number, truth, text, list } kind = Kind::unknown;
    // Of KRL's numbers, and of a place what it holds; any: its declaration is not in the files.
    enum class Type { any, integer, real } type = Type::any;
    double number = 0;
    std::string text;  // of a text; of what is unknown: its name
    std::vector<Value> parts;
    std::vector<std::string> names;  // beside parts, of a record
    bool pose = false;               // p[..] of URScript
    bool constant = false;           // CONST of RAPID: nobody gives it another value
    bool operator==(const Value&) const = default;
    static Value of(double number);
    static Value of_truth(bool truth);
    static Value of_text(std::string text);
    static Value unknown(std::string name);
    static Value list(std::vector<Value> parts);
    static Value numbers(std::initializer_list<double> numbers);
    bool known() const { return kind != Kind::unknown; }
    std::optional<double> as_number() const;
    std::optional<bool> as_truth() const;
    const Value* part(std::string_view name) const;  // of a record
};

// Six numbers that are known and below 1e9.
std::optional<std::array<double, 6>> six_numbers(const Value& value);

inline constexpr int kDeepestNesting = 100;  // of blocks

struct Statement;
using Block = std::vector<Statement>;
struct Statement {
    enum class Kind { simple, branch, count, loop } kind = Kind::simple;
    int file = 0, line = 0;
    std::vector<Token> tokens;                        // simple
    std::vector<std::pair<ExprPtr, Block>> branches;  // no condition: ELSE. count, loop: one, its body
    std::string variable;                             // count
    ExprPtr from, to, step;
    bool condition_last =
        false;  // REPEAT: the body runs before `branches[0].first` is asked, until it is true
};

struct Parameter {
    // either: the program does not say; what the routine gives it is not known to who called it.
    enum class Way { value, reference, either } way = Way::value;
    std::string name;
    bool optional = false;  // RAPID: by its name alone
    ExprPtr otherwise;      // URScript: where it is left out
};

struct Routine {
    std::string name;
    int file = 0;
    bool own = false;  // seen in its own file alone
    Value::Type returns = Value::Type::any;
    std::vector<Parameter> parameters;
    Block body;
};

struct Source {
    std::string name;
    std::vector<std::string> lines;
};

// A frame or a tool: known, or by its name alone.
struct NamedPose {
    std::string name;
    std::optional<Pose> pose;
    bool changed = false;  // by the program, to what it does not say: its name means nothing any more
};

// Its values and expressions are machine_values.cpp, what a name means machine_scopes.cpp, its points machine_motions.cpp, its
// routines, branches and loops machine_flow.cpp.
//
// Names. A name is looked for in the routine that runs, then in its module, then among all modules'. A module is a file; of KRL a
// .src and its .dat. What is given by reference is the giver's own place, however deep the calls.
class Machine {
  public:
    Machine(Dialect dialect, const ProgramPathOptions& options) : dialect_(dialect), options_(options) {}
    virtual ~Machine() = default;
    Machine(const Machine&) = delete;
    Machine& operator=(const Machine&) = delete;

    // Reads one file into routines and global values; the first file is the program.
    virtual void load(int file, std::string_view text) = 0;
    Expected<ProgramPath> run(std::vector<Source> sources, const std::string& name);

  protected:
    // leave: EXIT of a loop; again: its next turn; back: RETURN, the routine's end; halt: the program's.
    enum class Flow { on, leave, again, back, halt };
    enum class Reach { routine, module, all };  // of a declaration

    virtual Flow execute(const Statement& statement) = 0;
    virtual Value call(const Expr& call) = 0;               // a function of the language
    virtual bool moves(const std::string& word) const = 0;  // the statement's first word is a motion
    virtual std::optional<std::string> preferred() const { return {}; }  // routine: main
    virtual void begin() {}
    virtual std::string module_name(const Source& source) const { return source.name; }
    virtual Value chained(const Value& a, const Value& b) { return Value::unknown((a.known() ? b : a).text); }
    virtual Value::Type type_of(const std::string& component) const;  // of a record

    // Values
    Value value_of(const Expr& e);
    const Value* find(const Expr& e);
    void assign(const Expr& place, Value value);
    // As its place holds it: an INT of KRL rounds. `name` is of what is not known then.
    void put_in(Value& place, Value value, const std::string& name) const;
    void declare(const std::string& name, Value value, Reach reach);
    const Value* variable(const std::string& name);
    void impose(const std::string& name, Value value);  // wherever it is declared
    bool in_routine() const { return depth_ > 0; }
    bool in_function() const { return depth_ > 1; }    // that the routine calls
    bool is_parameter(const std::string& name) const;  // of the routine that runs
    void type_parameter(const std::string& name, Value::Type type);
    std::string root_of(const Expr& place) const;  // the variable that it is or is part of
    // What somebody else was given by reference is not known any more.
    void lose(const std::vector<Argument>& arguments);
    int module() const { return modules_of_[static_cast<std::size_t>(now_file_)]; }
    const Routine* routine(const std::string& name, int file) const;
    void add_routine(Routine routine);  // the first of a name in its module counts
    // Counts so many steps; false where the program has run its course.
    bool spend(std::size_t steps);
    bool afford(
        const Value& copied);  // by its size: an array that is copied again and again is a long program too
    // Runs a routine of the program; false: there is none of that name.
    bool enter(const std::string& name, const std::vector<Argument>& arguments, Flow& flow,
               Value* result = nullptr);
    Flow give_back(const Value& result);  // RETURN
    Flow turn_over();                     // the next turn of a loop
    Flow leave_loop();
    Flow run_statement(const Statement& statement);

    // Notes. A line keeps its weightiest.
    void note(int file, int line, LineKind kind, Text why = {});
    void note(LineKind kind, Text why = {}) { note(now_file_, now_line_, kind, std::move(why)); }
    void gap(Text why);  // a motion that is not understood: from here on nobody knows where the robot stands
    void remark(Text text);

    // Motions, in the active frame.
    void move(const Pose& frame_from_tool, ProgramMotion motion, const std::string& name);
    // Through `via`; `angle_rad` 0: to `end`, else so far from the start, negative: the other way round.
    void arc(const Pose& via, const Pose& end, const std::string& name, double angle_rad = 0);
    void joint_values();
    void set_frame(NamedPose frame);
    // One whose value changes under its name is another one.
    void set_tool(const std::string& name, const Value& value);
    std::optional<Pose> here() const { return here_; }  // in the active frame
    bool in_doubt() const { return doubt_ > 0; }

    Dialect dialect_;
    const ProgramPathOptions& options_;
    std::multimap<std::string, Routine> routines_;
    std::vector<std::string> routine_order_;
    std::map<std::string, Value> globals_;
    std::set<std::string> volatile_;  // variables that something else changes beside the program
    std::set<int> with_data_;         // KRL: modules whose data list was read
    bool loops_declare_ = false;      // the variable of FOR is the loop's own
    NamedPose frame_{"", Pose::Identity()};
    std::string tool_;
    bool fixed_tool_ = false;  // the tool stands in the room and the part moves
    int now_file_ = 0, now_line_ = 0;

  private:
    Flow run_block(const Block& block);
    Flow run_branch(const Statement& statement);
    Flow run_count(const Statement& statement);
    Flow run_loop(const Statement& statement);
    Flow run_again(const Block& body, bool counted = false);
    Flow run_unknown_loop(const Statement& statement);
    Flow run_turns(const Statement& statement, std::size_t begin);
    void note_jump();
    bool in_moving_routine();
    void drop_points(std::size_t from);
    void forget(const Block& block);
    void count(const std::string& name, Value value);
    Flow turns(const Statement& statement, double from, double to, double step);
    void run_in_doubt(const Statement& statement, const Text& why, std::size_t from = 0);
    bool holds_motion(const Block& block, std::set<std::string>& seen) const;
    void called_by(const Block& block, std::set<std::string>& names) const;
    Expected<std::string> chosen_routine(const std::string& where) const;
    Value binary(const Expr& e);
    Value arithmetic(const std::string& op, const Value& a, const Value& b, const Expr& e) const;
    // A place of who called, as a parameter holds it.
    struct Given {
        ExprPtr place;
        std::size_t depth = 0;
        int file = 0;
    };
    struct Scope {
        std::map<std::string, Value> values;
        std::map<std::string, Given> given;
        const Routine* routine = nullptr;
    };
    const Given* given_as(const std::string& name) const;
    template <class Function>
    auto as_given(const Given& given, Function function);
    Value* home(const std::string& name);
    Value* slot(const Expr& place);
    Value* component_of(Value& record, const std::string& name) const;
    std::optional<std::vector<double>> indices_of(const Expr& place);
    ExprPtr frozen(const Expr& place);
    bool shared(const std::string& name) const;
    Scope scope_of(const Routine& routine, const std::vector<Argument>& arguments);
    void lose_given(const Routine& routine, const std::vector<Argument>& arguments, const Scope& before,
                    const Scope& after);
    static const Parameter* parameter_of(const Routine& routine, const Argument& argument,
                                         std::size_t& place);
    void put(const Pose& frame_from_tool, ProgramMotion motion, const std::string& name);
    void settle_joint_values();

    ProgramPath path_;
    std::vector<std::map<int, ProgramLine>> lines_;  // by file
    std::vector<Source> sources_;
    std::vector<Scope> scopes_;
    std::size_t depth_ = 0;        // scopes_[depth_ - 1] is seen
    std::vector<int> modules_of_;  // by file
    std::vector<std::map<std::string, Value>> modules_;
    std::map<std::string, int> undeclared_;  // KRL: the module that first gave them a value
    Value returned_;
    bool returned_in_doubt_ = false, over_ = false;
    bool counted_ = false;  // the program says how often the loop at hand runs
    std::map<const Routine*, bool> moving_;
    struct JointMove {
        int file, line;
        std::size_t before;  // points that stood before it
    };
    std::vector<JointMove> joints_;
    std::optional<Pose> here_;
    std::vector<std::string> tools_;  // of the points, without repeats
    std::map<std::string, std::vector<Value>> tool_values_;
    int doubt_ = 0, loops_ = 0, quiet_ = 0;
    Text doubt_why_;
    std::size_t steps_ = 0;
    bool too_long_ = false, too_many_ = false;
};

std::unique_ptr<Machine> krl_machine(const ProgramPathOptions& options);
std::unique_ptr<Machine> rapid_machine(const ProgramPathOptions& options);
std::unique_ptr<Machine> urscript_machine(const ProgramPathOptions& options);
std::unique_ptr<Machine> fanuc_machine(const ProgramPathOptions& options);
std::unique_ptr<Machine> apt_machine(const ProgramPathOptions& options);

}  // namespace seamwright::program_path
