#pragma once
// What the languages have in common: values, statements as a tree, and the run through them that gathers points and notes.

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "devices/robot_path/robot_path.h"
#include "devices/robot_path/tokens.h"

namespace seamwright::program_path {

// Numbers, truths, texts, and lists of values that may have names (records of KRL, named components of RAPID are by place).
struct Value {
    enum class Kind { unknown, number, truth, text, list } kind = Kind::unknown;
    double number = 0;
    std::string text;  // of a text; of what is unknown: its name
    std::vector<Value> parts;
    std::vector<std::string> names;  // beside parts, of a record
    bool pose = false;               // p[..] of URScript
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

struct Routine {
    std::string name;
    int file = 0;
    std::vector<std::string> parameters;  // by place; RAPID's optional ones are left out
    std::map<std::string, ExprPtr> defaults;
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
};

// Its values and expressions are machine_values.cpp, its points machine_motions.cpp, its routines, branches and loops
// machine_flow.cpp.
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
    enum class Flow { on, leave, back };  // leave: EXIT of a loop; back: RETURN, the routine's end

    virtual Flow execute(const Statement& statement) = 0;
    virtual Value call(const Expr& call) = 0;               // a function of the language
    virtual bool moves(const std::string& word) const = 0;  // the statement's first word is a motion
    virtual std::optional<std::string> preferred() const { return {}; }  // routine: main
    virtual void begin() {}

    // Values
    Value value_of(const Expr& e);
    const Value* find(const Expr& e);
    void assign(const Expr& place, Value value);
    void declare(const std::string& name, Value value, bool local);
    const Value* variable(const std::string& name) const;
    // Runs a routine of the program; false: there is none of that name.
    bool enter(const std::string& name, const std::vector<Argument>& arguments, Flow& flow);
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
    std::optional<Pose> here() const { return here_; }  // in the active frame
    bool in_doubt() const { return doubt_ > 0; }

    Dialect dialect_;
    const ProgramPathOptions& options_;
    std::map<std::string, Routine> routines_;
    std::vector<std::string> routine_order_;
    std::map<std::string, Value> globals_;
    std::set<std::string> volatile_;  // variables that something else changes beside the program
    NamedPose frame_{"", Pose::Identity()};
    std::string tool_;
    bool fixed_tool_ = false;  // the tool stands in the room and the part moves
    int now_file_ = 0, now_line_ = 0;

  private:
    Flow run_block(const Block& block);
    Flow run_branch(const Statement& statement);
    Flow run_count(const Statement& statement);
    Flow run_loop(const Statement& statement);
    Flow run_again(const Block& body);
    Flow run_unknown_loop(const Statement& statement);
    Flow run_turns(const Statement& statement, std::size_t begin);
    void drop_points(std::size_t from);
    void forget(const Block& block);
    void run_in_doubt(const Statement& statement, const Text& why, std::size_t from = 0);
    bool holds_motion(const Block& block, std::set<std::string>& seen) const;
    void called_by(const Block& block, std::set<std::string>& names) const;
    Expected<std::string> chosen_routine(const std::string& where) const;
    Value binary(const Expr& e);
    void put(const Pose& frame_from_tool, ProgramMotion motion, const std::string& name);
    void settle_joint_values();

    ProgramPath path_;
    std::vector<std::map<int, ProgramLine>> lines_;  // by file
    std::vector<Source> sources_;
    std::vector<std::map<std::string, Value>> scopes_;
    struct JointMove {
        int file, line;
        std::size_t before;  // points that stood before it
    };
    std::vector<JointMove> joints_;
    std::optional<Pose> here_;
    std::vector<std::string> tools_;  // of the points, without repeats
    int doubt_ = 0, loops_ = 0;
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
