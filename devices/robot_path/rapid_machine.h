#pragma once
// RAPID, shared by the sources that make it up: the text as a tree (rapid_text.cpp) and what it does (rapid.cpp).

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "devices/robot_path/machine/machine.h"

namespace seamwright::program_path {

class Rapid final : public Machine {
  public:
    explicit Rapid(const ProgramPathOptions& options);
    void load(int file, std::string_view text) override;

  protected:
    bool moves(const std::string& word) const override;
    std::optional<std::string> preferred() const override { return "main"; }
    void begin() override;
    Flow execute(const Statement& s) override;
    Value call(const Expr& e) override;

  private:
    // Which statements move, and how many of their first positions are poses. Instructions of process packages end in the same
    // letters (ArcL, DispC, PaintL, SpotJ): the letter behind the name tells the motion.
    struct Instruction {
        ProgramMotion motion;
        bool absolute = false, only_external = false, search = false;
    };
    static std::optional<Instruction> instruction(std::string_view word);

    static bool declares(const Cursor& c);
    void declaration(Cursor& c);

    static bool closes(const Cursor& c);
    ExprPtr condition(Cursor& c);
    Block block(Cursor& c, int depth);
    // A statement without blocks, up to its semicolon.
    Statement one(Cursor& c);
    Statement statement(Cursor& c, int depth);
    void routine(Cursor& c, bool own);
    using Machine::routine;

    std::optional<Value> counted(const std::string& name, const std::vector<Argument>& arguments);
    Flow instruction_call(const std::string& name, const std::vector<Argument>& arguments);

    // base_from_frame of a work object; nullopt: it moves with the robot or a positioner, or is not known.
    std::optional<Pose> frame_of(const Value& wobj) const;
    void motion(const Instruction& how, const std::vector<Argument>& arguments);

    std::vector<Token> tokens_;
    int file_ = 0;
    bool displaced_ = false;
    std::optional<Pose> displacement_;
};

}  // namespace seamwright::program_path
