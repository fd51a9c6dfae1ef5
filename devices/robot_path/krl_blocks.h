#pragma once
// The statements of KRL as a tree. Private to krl.cpp.

#include <initializer_list>
#include <string_view>
#include <vector>

#include "devices/robot_path/machine/machine.h"

namespace seamwright::program_path {

// One line each; blocks by their closing words. What is never closed ends with its routine.
class KrlBlocks {
  public:
    KrlBlocks(std::vector<std::vector<Token>> lines, int file) : lines_(std::move(lines)), file_(file) {}

    bool done() const { return at_ >= lines_.size(); }
    const std::vector<Token>& line() const { return lines_[at_]; }
    void next() { ++at_; }

    // Up to a line that begins with one of `ends`, or with what ends any routine; that line stays.
    Block block(std::initializer_list<std::string_view> ends, int depth);
    bool begins_or_ends_routine() const;
    bool begins_routine() const;

  private:
    bool is(std::string_view word) const { return !done() && line().front().text == word; }
    Statement statement(int depth);
    void choice(Statement& s, const ExprPtr& what, int depth);

    std::vector<std::vector<Token>> lines_;
    int file_;
    std::size_t at_ = 0;
};

}  // namespace seamwright::program_path
