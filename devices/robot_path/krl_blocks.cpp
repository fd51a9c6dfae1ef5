#include "devices/robot_path/krl_blocks.h"

#include <algorithm>

namespace seamwright::program_path {
namespace {

// What cannot be read is not known: what hangs on it is in doubt.
ExprPtr no_value() {
    auto e = std::make_shared<Expr>();
    e->kind = Expr::Kind::name;
    e->text = "?";
    return e;
}

ExprPtr read_condition(Cursor& c) {
    try {
        return read_expression(c, Dialect::krl);
    } catch (const Misread&) {
        return no_value();
    }
}

std::vector<Argument> read_cases(Cursor& c) {
    try {
        auto cases = read_arguments(c, Dialect::krl, "");
        return cases.size() > 60 ? std::vector<Argument>{{{}, no_value()}} : cases;
    } catch (const Misread&) {
        return {{{}, no_value()}};
    }
}

}  // namespace

Block KrlBlocks::block(std::initializer_list<std::string_view> ends, int depth) {
    Block all;
    for (; !done(); ++at_) {
        const std::string& word = line().front().text;
        if (std::find(ends.begin(), ends.end(), word) != ends.end() || begins_or_ends_routine()) return all;
        all.push_back(statement(depth));
        if (done() || begins_or_ends_routine()) return all;
    }
    return all;
}

bool KrlBlocks::begins_or_ends_routine() const {
    const std::string& word = line().front().text;
    return word == "END" || word == "ENDFCT" || begins_routine();
}

bool KrlBlocks::begins_routine() const {
    const std::string& word = line().front().text;
    const std::string second = line().size() > 1 ? line()[1].text : "";
    return word == "DEF" || word == "DEFFCT" || (word == "GLOBAL" && (second == "DEF" || second == "DEFFCT"));
}

// Leaves the line that ends it as the one at hand.
Statement KrlBlocks::statement(int depth) {
    Statement s;
    s.file = file_;
    s.line = line().front().line;
    s.tokens = line();
    if (depth >= kDeepestNesting) return s;
    Cursor c(line());
    {
        if (c.accept("IF")) {
            auto condition = read_condition(c);
            s.kind = Statement::Kind::branch;
            s.tokens.clear();
            ++at_;
            s.branches.emplace_back(condition, block({"ELSE", "ENDIF"}, depth + 1));
            if (is("ELSE")) {
                ++at_;
                s.branches.emplace_back(nullptr, block({"ENDIF"}, depth + 1));
            }
        } else if (c.accept("FOR")) {
            s.variable = c.peek().text;
            if (!c.done()) c.take();
            c.accept("=");
            s.from = read_condition(c);
            s.to = c.accept("TO") ? read_condition(c) : no_value();
            if (c.accept("STEP")) s.step = read_condition(c);
            s.kind = Statement::Kind::count;
            s.tokens.clear();
            ++at_;
            s.branches.emplace_back(nullptr, block({"ENDFOR"}, depth + 1));
        } else if (c.accept("WHILE")) {
            auto condition = read_condition(c);
            s.kind = Statement::Kind::loop;
            s.tokens.clear();
            ++at_;
            s.branches.emplace_back(condition, block({"ENDWHILE"}, depth + 1));
        } else if (c.accept("LOOP")) {
            s.kind = Statement::Kind::loop;
            s.tokens.clear();
            ++at_;
            s.branches.emplace_back(nullptr, block({"ENDLOOP"}, depth + 1));
        } else if (c.accept("REPEAT")) {
            s.kind = Statement::Kind::loop;
            s.condition_last = true;
            s.tokens.clear();
            ++at_;
            Block body = block({"UNTIL"}, depth + 1);
            ExprPtr until;
            if (is("UNTIL")) {
                Cursor u(line());
                u.take();
                until = read_condition(u);
            }
            s.branches.emplace_back(until, std::move(body));
        } else if (c.accept("SWITCH")) {
            choice(s, read_condition(c), depth);
        }
    }
    if (done()) at_ = lines_.size() - 1;
    if (begins_or_ends_routine() && at_ > 0) --at_;  // block() goes on behind it
    return s;
}

void KrlBlocks::choice(Statement& s, const ExprPtr& what, int depth) {
    s.kind = Statement::Kind::branch;
    s.tokens.clear();
    ++at_;
    while (is("CASE") || is("DEFAULT")) {
        Cursor c(line());
        ExprPtr any;
        if (c.take().text == "CASE") {
            for (const Argument& a : read_cases(c)) {
                if (!a.value) continue;
                auto same = std::make_shared<Expr>();
                same->kind = Expr::Kind::binary;
                same->text = "==";
                same->parts = {{{}, what}, {{}, a.value}};
                if (any) {
                    auto either = std::make_shared<Expr>();
                    either->kind = Expr::Kind::binary;
                    either->text = "OR";
                    either->parts = {{{}, any}, {{}, same}};
                    any = either;
                } else {
                    any = same;
                }
            }
        }
        ++at_;
        s.branches.emplace_back(any, block({"CASE", "DEFAULT", "ENDSWITCH"}, depth + 1));
    }
}

}  // namespace seamwright::program_path
