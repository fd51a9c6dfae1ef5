#include <fmt/format.h>

#include <algorithm>

#include "devices/controllers/kuka/krl/krl_reader.h"

namespace seamwright::krl {
namespace {

class Parser {
  public:
    explicit Parser(const std::string& text) : lines_(lines_of(text)) {}

    template <class F>
    auto told(F read) {
        try {
            return read();
        } catch (const KrlError& e) {
            const std::string what = e.what();
            if (what.starts_with("line ")) throw;
            const std::size_t at = std::min(at_ == 0 ? 0 : at_ - 1, lines_.empty() ? 0 : lines_.size() - 1);
            throw KrlError(fmt::format("line {}: {}", lines_.empty() ? 0 : lines_[at].number, what));
        }
    }

    Module program(const std::string& name) {
        Module m;
        m.name = name;
        while (at_ < lines_.size()) m.routines.push_back(routine(name));
        if (m.routines.empty() || m.routines.front()->name != name)
            throw KrlError(fmt::format("the first program of the file must be {}", name));
        return m;
    }

    Module data(const std::string& name) {
        Module m;
        m.name = name;
        m.is_data = true;
        Reader head = line();
        head.expect("DEFDAT");
        if (head.new_name() != name) throw KrlError(fmt::format("the data list must be named {}", name));
        m.is_public = head.accept("PUBLIC");
        head.end();
        for (;;) {
            if (at_ >= lines_.size()) throw KrlError("ENDDAT is missing");
            Reader r = line();
            if (r.accept("ENDDAT")) {
                r.end();
                break;
            }
            if (declares(r)) {
                for (Declaration& d : declaration(r, true)) {
                    if (d.global && !m.is_public) throw KrlError("GLOBAL wants DEFDAT ... PUBLIC");
                    m.declarations.push_back(std::move(d));
                }
                continue;
            }
            Statement s;
            s.kind = Statement::Kind::assign;
            s.line = r.number();
            s.target = place_or_call(r);
            r.expect("=");
            s.value = expression(r);
            r.end();
            if (!s.target->row)
                throw KrlError("only CHAR arrays are given values by a line of their own in a data list");
            m.assignments.push_back(std::move(s));
        }
        if (at_ < lines_.size()) throw KrlError("nothing may follow ENDDAT");
        return m;
    }

  private:
    Reader line() {
        if (at_ >= lines_.size()) throw KrlError("the file ends too early");
        return Reader(lines_[at_++]);
    }
    static bool declares(const Reader& r) {
        return r.is("DECL") || (r.is("GLOBAL") && r.peek(1).text != "INTERRUPT") ||
               (type_from(r.peek().text) && r.peek(1).kind == TokenKind::name);
    }

    std::vector<Declaration> declaration(Reader& r, bool in_data_list) {
        r.accept("DECL");
        const bool global = r.accept("GLOBAL");
        if (global && !in_data_list) throw KrlError("GLOBAL variables stand in data lists");
        const bool constant = r.accept("CONST");
        if (constant && !in_data_list) throw KrlError("CONST stands in data lists");
        const Token type_name = r.take();
        const auto type = type_from(type_name.text);
        if (!type) throw KrlError(fmt::format("{} is no type", type_name.text));
        std::vector<Declaration> all;
        do {
            Declaration d;
            d.line = r.number();
            d.type = *type;
            d.global = global;
            d.name = r.new_name();
            if (r.accept("[")) {
                if (r.accept("]")) {
                    d.dimensions.push_back(0);
                } else {
                    do {
                        const Token size = r.take();
                        if (size.kind != TokenKind::integer || !(size.number >= 1))
                            throw KrlError(fmt::format("{} is no size of an array", size.text));
                        d.dimensions.push_back(static_cast<long>(size.number));
                    } while (r.accept(","));
                    r.expect("]");
                    if (d.dimensions.size() > 3) throw KrlError("arrays have at most three dimensions");
                }
            }
            if (r.accept("=")) {
                if (!in_data_list) throw KrlError("only data lists give values with a declaration");
                d.initial = expression(r);
            } else if (constant) {
                throw KrlError(fmt::format("the constant {} has no value", d.name));
            }
            all.push_back(std::move(d));
        } while (r.accept(","));
        r.end();
        return all;
    }

    std::shared_ptr<const Routine> routine(const std::string& module) {
        auto routine = std::make_shared<Routine>();
        routine->module = module;
        Reader head = line();
        routine->global = head.accept("GLOBAL");
        const bool function = head.accept("DEFFCT");
        if (function) {
            const Token type_name = head.take();
            routine->returns = type_from(type_name.text);
            if (!routine->returns) throw KrlError(fmt::format("{} is no type", type_name.text));
        } else {
            head.expect("DEF");
        }
        routine->name = head.new_name();
        head.expect("(");
        while (!head.accept(")")) {
            Parameter p;
            p.name = head.new_name();
            if (head.accept("[")) {
                head.expect("]");
                p.array = true;
            }
            head.expect(":");
            p.out = head.accept("OUT");
            if (!p.out) head.expect("IN");
            if (p.array && !p.out)
                throw KrlError(fmt::format("{}[]: whole arrays are handed over with OUT only", p.name));
            routine->parameters.push_back(p);
            if (!head.is(")")) head.expect(",");
        }
        head.end();
        while (at_ < lines_.size() && declares(Reader(lines_[at_]))) {
            Reader r = line();
            for (Declaration& d : declaration(r, false)) routine->declarations.push_back(std::move(d));
        }
        for (const Parameter& p : routine->parameters) {
            const auto d = std::find_if(routine->declarations.begin(), routine->declarations.end(),
                                        [&](const Declaration& known) { return known.name == p.name; });
            if (d == routine->declarations.end())
                throw KrlError(fmt::format("parameter {} is not declared", p.name));
            if (p.array != !d->dimensions.empty())
                throw KrlError(
                    fmt::format("parameter {} is declared otherwise than it is handed over", p.name));
        }
        const std::string end = function ? "ENDFCT" : "END";
        routine->body = block({end});
        line();
        return routine;
    }

    // Statements up to a line that begins with one of `ends`, which stays.
    Block block(const std::vector<std::string>& ends) {
        Block all;
        for (;;) {
            if (at_ >= lines_.size()) throw KrlError(fmt::format("{} is missing", ends.back()));
            const Reader next(lines_[at_]);
            if (std::any_of(ends.begin(), ends.end(), [&](const std::string& e) { return next.is(e); }))
                return all;
            all.push_back(statement());
        }
    }
    void closing(const std::string& word) {
        Reader r = line();
        r.expect(word);
        r.end();
    }

    Statement statement() {
        Reader r = line();
        if (declares(r)) throw KrlError("declarations stand before the first statement");
        Statement s;
        s.line = r.number();
        using Kind = Statement::Kind;
        if (r.accept("IF")) {
            s.kind = Kind::if_;
            s.value = expression(r);
            r.expect("THEN");
            r.end();
            s.blocks.push_back(block({"ELSE", "ENDIF"}));
            Reader next = line();
            if (next.accept("ELSE")) {
                next.end();
                s.blocks.push_back(block({"ENDIF"}));
                closing("ENDIF");
            }
        } else if (r.accept("FOR")) {
            s.kind = Kind::for_;
            s.target = place_or_call(r);
            r.expect("=");
            s.value = expression(r);
            r.expect("TO");
            s.second = expression(r);
            r.end();
            s.blocks.push_back(block({"ENDFOR"}));
            closing("ENDFOR");
        } else if (r.accept("WHILE")) {
            s.kind = Kind::while_;
            s.value = expression(r);
            r.end();
            s.blocks.push_back(block({"ENDWHILE"}));
            closing("ENDWHILE");
        } else if (r.accept("REPEAT")) {
            s.kind = Kind::repeat;
            r.end();
            s.blocks.push_back(block({"UNTIL"}));
            Reader until = line();
            until.expect("UNTIL");
            s.value = expression(until);
            until.end();
        } else if (r.accept("LOOP")) {
            s.kind = Kind::loop;
            r.end();
            s.blocks.push_back(block({"ENDLOOP"}));
            closing("ENDLOOP");
        } else if (r.accept("SWITCH")) {
            switch_block(s, r);
        } else if (r.accept("WAIT")) {
            const bool seconds = r.accept("SEC");
            if (!seconds) r.expect("FOR");
            s.kind = seconds ? Kind::wait_sec : Kind::wait_for;
            s.value = expression(r);
        } else if (r.accept("TRIGGER")) {
            trigger(s, r);
        } else if (r.is("INTERRUPT") || r.is("GLOBAL")) {
            interrupt(s, r);
        } else {
            simple(s, r);
        }
        if (!r.done() && s.blocks.empty()) r.end();
        return s;
    }

    void switch_block(Statement& s, Reader& r) {
        s.kind = Statement::Kind::switch_;
        s.value = expression(r);
        r.end();
        for (;;) {
            Reader next = line();
            if (next.accept("ENDSWITCH")) {
                next.end();
                break;
            }
            std::vector<ExpressionPtr> values;
            if (!next.accept("DEFAULT")) {
                next.expect("CASE");
                do values.push_back(expression(next));
                while (next.accept(","));
            } else if (!s.cases.empty() && s.cases.back().empty()) {
                throw KrlError("DEFAULT stands twice");
            }
            next.end();
            s.cases.push_back(std::move(values));
            s.blocks.push_back(block({"CASE", "DEFAULT", "ENDSWITCH"}));
        }
        if (s.cases.empty() || s.cases.front().empty()) throw KrlError("SWITCH wants a CASE first");
    }

    void trigger(Statement& s, Reader& r) {
        s.kind = Statement::Kind::trigger;
        r.expect("WHEN");
        r.expect("PATH");
        r.expect("=");
        s.value = expression(r);
        r.expect("DELAY");
        r.expect("=");
        s.second = expression(r);
        r.expect("DO");
        Statement what;
        what.line = s.line;
        simple(what, r);
        using Kind = Statement::Kind;
        if (what.kind != Kind::assign && what.kind != Kind::call && what.kind != Kind::pulse)
            throw KrlError("TRIGGER does assignments, PULSE and calls only");
        if (what.kind == Kind::call) {
            r.expect("PRIO");
            r.expect("=");
            s.third = expression(r);
        }
        r.end();
        s.blocks.push_back({std::move(what)});
    }

    static void interrupt(Statement& s, Reader& r) {
        using Kind = Statement::Kind;
        s.global = r.accept("GLOBAL");
        r.expect("INTERRUPT");
        if (!s.global && (r.is("ON") || r.is("OFF"))) {
            s.kind = r.take().text == "ON" ? Kind::interrupt_on : Kind::interrupt_off;
            s.value = expression(r);
            return;
        }
        s.kind = Kind::interrupt_decl;
        r.expect("DECL");
        s.value = expression(r);
        r.expect("WHEN");
        s.second = expression(r);
        r.expect("DO");
        s.third = place_or_call(r);
        if (s.third->kind != Expression::Kind::call)
            throw KrlError("INTERRUPT calls a program, written with brackets");
    }

    // One line's statements.
    static void simple(Statement& s, Reader& r) {
        using Kind = Statement::Kind;
        const auto motion = [&](Kind kind) {
            s.kind = kind;
            s.value = expression(r);
            s.approximates = kind != Kind::ptp && r.accept("C_DIS");
        };
        if (r.accept("EXIT")) {
            s.kind = Kind::exit;
        } else if (r.accept("HALT")) {
            s.kind = Kind::halt;
        } else if (r.accept("BRAKE")) {
            s.kind = Kind::brake;
            r.accept("F");
        } else if (r.accept("RESUME")) {
            s.kind = Kind::resume;
        } else if (r.accept("RETURN")) {
            s.kind = Kind::return_;
            if (!r.done()) s.value = expression(r);
        } else if (r.accept("LIN")) {
            motion(Kind::lin);
        } else if (r.accept("LIN_REL")) {
            motion(Kind::lin_rel);
        } else if (r.accept("PTP")) {
            motion(Kind::ptp);
        } else if (r.accept("PULSE")) {
            s.kind = Kind::pulse;
            r.expect("(");
            s.target = place_or_call(r);
            r.expect(",");
            s.value = expression(r);
            r.expect(",");
            s.second = expression(r);
            r.expect(")");
        } else {
            auto place = place_or_call(r);
            if (place->kind == Expression::Kind::call) {
                s.kind = Kind::call;
                s.value = place;
            } else {
                s.kind = Kind::assign;
                s.target = place;
                r.expect("=");
                s.value = expression(r);
            }
        }
    }

    const std::vector<Line> lines_;
    std::size_t at_ = 0;
};

}  // namespace

Module parse_module(const std::string& file_name, const std::string& text) {
    const auto dot = file_name.rfind('.');
    const std::string name = capitals(file_name.substr(0, dot));
    const std::string ending = dot == std::string::npos ? "" : capitals(file_name.substr(dot + 1));
    try {
        if (name.size() > kLongestName)
            throw KrlError(fmt::format("a file's name has at most {} characters", kLongestName));
        if (is_reserved(name)) throw KrlError(fmt::format("{} is a word of KRL and names no file", name));
        Parser parser(text);
        if (ending == "DAT") return parser.told([&] { return parser.data(name); });
        if (ending == "SRC" || ending == "SUB") return parser.told([&] { return parser.program(name); });
        throw KrlError("the ending is none of KRL's");
    } catch (const KrlError& e) {
        throw KrlError(fmt::format("{}: {}", file_name, e.what()));
    }
}

ExpressionPtr parse_expression(const std::string& text) {
    const auto lines = lines_of(text);
    if (lines.size() != 1) throw KrlError("one value is expected");
    Reader r(lines.front());
    auto e = expression(r);
    r.end();
    return e;
}

}  // namespace seamwright::krl
