#pragma once
// FANUC's TP programs, shared by the sources that make them up: the text as a tree (fanuc_text.cpp) and what it does
// (fanuc.cpp).

#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/geometry/notation.h"
#include "devices/robot_path/machine/machine.h"

namespace seamwright::program_path {

inline Pose pose_from(const std::array<double, 6>& n) {
    return make_pose(rotation_from_fanuc({n[3], n[4], n[5]}), {n[0], n[1], n[2]});
}

class Fanuc final : public Machine {
  public:
    explicit Fanuc(const ProgramPathOptions& options) : Machine(Dialect::rapid, options) {
        set_frame({"", Pose::Identity()});
    }

    void load(int file, std::string_view text) override;

  protected:
    bool moves(const std::string& word) const override {
        return word == "j" || word == "l" || word == "c" || word == "a" || word == "s";
    }

    void begin() override;
    Flow execute(const Statement& s) override;
    Value call(const Expr& e) override { return Value::unknown(shown(e)); }

  private:
    struct Position {
        std::optional<Pose> pose;
        bool joints = false;
        std::string frame, tool, label;
    };

    // R[1:count], P[3], PR[2,3], LBL[4:x] as one word each. With `with_registers` P[R[1]] too, by what R[1] holds.
    std::vector<Token> collapsed(const std::vector<Token>& tokens, bool with_registers);

    ExprPtr condition(const std::vector<Token>& tokens, std::size_t from, std::size_t to);
    static std::size_t index_of(const std::vector<Token>& tokens, std::string_view word);
    static std::size_t comma_of(const std::vector<Token>& tokens);
    static std::string label_of(const std::vector<Token>& tokens, std::size_t from);
    static bool closes(const Statement& s);
    // Up to a closing word. A jump forward over statements of the same block leaves them out, or, with a condition, makes
    // them hang on it.
    Block block(const std::vector<Statement>& flat, std::size_t& at, int depth);
    void read_position(int file, int line, std::string_view text);

    void give(const std::string& word, Cursor& c);
    NamedPose user_frame(const std::string& number) const;
    std::optional<Position> position(const std::string& word);
    void motion(const std::string& word, Cursor& c);
    static std::string capitals(std::string name);

    std::map<std::pair<int, int>, Position> positions_;  // by file and number: each program has its own
    std::map<std::string, std::optional<Pose>> frames_;
    std::string frame_number_ = "?", tool_number_ = "?", offset_, tool_offset_;
};

}  // namespace seamwright::program_path
