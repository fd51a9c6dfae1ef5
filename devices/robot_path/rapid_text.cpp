// RAPID: modules of data and routines, their statements and blocks as a tree.

#include <memory>
#include <set>
#include <utility>

#include "devices/robot_path/rapid_machine.h"

namespace seamwright::program_path {

void Rapid::load(int file, std::string_view text) {
    tokens_.clear();
    for (Token& t : tokens_of(text, Dialect::rapid))
        if (t.kind != Token::Kind::newline) tokens_.push_back(std::move(t));
    file_ = file;
    Cursor c(tokens_);
    while (!c.done() && !c.is("module")) c.take();  // %%% VERSION:1 LANGUAGE:ENGLISH %%%
    while (!c.done()) {
        const Token t = c.peek();
        std::size_t skip = c.is("local") || c.is("task") ? 1 : 0;
        if (c.is("proc", skip) || c.is("func", skip) || c.is("trap", skip)) {
            const bool own = skip > 0 && c.is("local");
            for (; skip > 0; --skip) c.take();
            routine(c, own);
        } else if (c.is("module")) {
            note(file_, t.line, LineKind::understood);
            while (!c.done() && c.peek().line == t.line) c.take();
        } else if (c.is("record")) {
            note(file_, t.line, LineKind::passed_over);
            while (!c.done() && !c.accept("endrecord")) c.take();
        } else if (c.is("endmodule")) {
            note(file_, t.line, LineKind::understood);
            c.take();
        } else {
            Statement s = one(c);
            const Flow ignored = run_statement(s);
            (void)ignored;
        }
    }
}

bool Rapid::closes(const Cursor& c) {
    static const std::set<std::string> words = {"endproc", "endfunc",  "endtrap", "endmodule", "error",
                                                "undo",    "backward", "endif",   "elseif",    "else",
                                                "endfor",  "endwhile", "case",    "default",   "endtest"};
    return c.peek().kind == Token::Kind::name && words.count(c.peek().text) > 0;
}

ExprPtr Rapid::condition(Cursor& c) {
    try {
        return read_expression(c, Dialect::rapid);
    } catch (const Misread&) {
        auto e = std::make_shared<Expr>();
        e->kind = Expr::Kind::name;
        e->text = "?";
        return e;
    }
}

Block Rapid::block(Cursor& c, int depth) {
    Block all;
    while (!c.done() && !closes(c)) all.push_back(statement(c, depth));
    return all;
}

Statement Rapid::one(Cursor& c) {
    Statement s;
    s.file = file_;
    s.line = c.peek().line;
    note(file_, s.line, LineKind::not_reached);
    while (!c.done() && !c.is(";")) {
        s.tokens.push_back(c.take());
        // A semicolon that was forgotten, or a label.
        if (s.tokens.size() == 2 && s.tokens[1].text == ":" && s.tokens[0].kind == Token::Kind::name)
            return s;
        if (closes(c) && c.peek().line != s.tokens.back().line) break;
    }
    c.accept(";");
    return s;
}

Statement Rapid::statement(Cursor& c, int depth) {
    Statement s;
    s.file = file_;
    s.line = c.peek().line;
    const bool shallow = depth < kDeepestNesting;
    note(file_, s.line, LineKind::not_reached);
    if (shallow && c.accept("if")) {
        s.kind = Statement::Kind::branch;
        auto asked = condition(c);
        if (!c.accept("then")) {
            s.branches.emplace_back(asked, Block{});
            s.branches.back().second.push_back(c.done() ? Statement{} : statement(c, depth + 1));
            return s;
        }
        s.branches.emplace_back(asked, block(c, depth + 1));
        for (;;) {
            if (c.accept("elseif")) {
                asked = condition(c);
                c.accept("then");
                s.branches.emplace_back(asked, block(c, depth + 1));
            } else if (c.accept("else")) {
                s.branches.emplace_back(nullptr, block(c, depth + 1));
            } else {
                c.accept("endif");
                return s;
            }
        }
    }
    if (shallow && c.accept("for")) {
        s.kind = Statement::Kind::count;
        s.variable = c.done() ? "" : c.take().text;
        c.accept("from");
        s.from = condition(c);
        c.accept("to");
        s.to = condition(c);
        if (c.accept("step")) s.step = condition(c);
        c.accept("do");
        s.branches.emplace_back(nullptr, block(c, depth + 1));
        c.accept("endfor");
        return s;
    }
    if (shallow && c.accept("while")) {
        s.kind = Statement::Kind::loop;
        auto asked = condition(c);
        c.accept("do");
        s.branches.emplace_back(asked, block(c, depth + 1));
        c.accept("endwhile");
        return s;
    }
    if (shallow && c.accept("test")) {
        s.kind = Statement::Kind::branch;
        const auto what = condition(c);
        for (;;) {
            if (c.accept("case")) {
                ExprPtr any;
                int cases = 0;
                do {
                    auto same = std::make_shared<Expr>();
                    same->kind = Expr::Kind::binary;
                    same->text = "=";
                    same->parts = {{{}, what}, {{}, condition(c)}};
                    if (!any || ++cases > 60) {
                        any = same;
                        continue;
                    }
                    auto either = std::make_shared<Expr>();
                    either->kind = Expr::Kind::binary;
                    either->text = "or";
                    either->parts = {{{}, any}, {{}, same}};
                    any = either;
                } while (c.accept(","));
                c.accept(":");
                s.branches.emplace_back(any, block(c, depth + 1));
            } else if (c.accept("default")) {
                c.accept(":");
                s.branches.emplace_back(nullptr, block(c, depth + 1));
            } else {
                c.accept("endtest");
                return s;
            }
        }
    }
    return one(c);
}

void Rapid::routine(Cursor& c, bool own) {
    Routine r;
    r.own = own;
    r.file = file_;
    const int line = c.peek().line;
    note(file_, line, LineKind::understood);
    const std::string kind = c.take().text;
    const std::string end = "end" + kind;
    if (kind == "func" && !c.done()) c.take();
    if (!c.done()) r.name = c.take().text;
    if (c.accept("(")) {
        while (!c.done() && !c.accept(")")) {
            const bool optional = c.accept("\\");
            std::string last;
            auto way = Parameter::Way::value;
            while (!c.done() && !c.is(",") && !c.is(")") && !c.is("|") && !c.is("\\")) {
                if (c.accept("{")) {
                    while (!c.done() && !c.accept("}")) c.take();
                    continue;
                }
                if (c.is("inout") || c.is("var") || c.is("pers")) way = Parameter::Way::reference;
                last = c.take().text;
            }
            if (!last.empty()) r.parameters.push_back({way, last, optional, nullptr});
            if (!c.accept(",")) c.accept("|");
        }
    }
    while (!c.done() && !c.is(end) && !c.is("endmodule")) {
        const std::size_t before = c.at();
        if (c.is("error") || c.is("undo") || c.is("backward")) {  // handlers run when something failed
            while (!c.done() && !c.is(end) && !c.is("endmodule")) c.take();
            break;
        }
        for (Statement& s : block(c, 0)) r.body.push_back(std::move(s));
        if (c.at() == before)
            c.take();  // a closing word of nothing
        else if (closes(c) && !c.is(end) && !c.is("error") && !c.is("undo") && !c.is("backward") &&
                 !c.is("endmodule"))
            c.take();
    }
    if (!c.done() && c.is(end)) {
        note(file_, c.peek().line, LineKind::understood);
        c.take();
    }
    if (r.name.empty() || kind == "trap") return;
    if (kind == "proc") routine_order_.push_back(r.name);
    add_routine(std::move(r));
}

}  // namespace seamwright::program_path
