// Text of a module to its tree: the grammar of RAPID, with its limits.

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "devices/controllers/abb/rapid/rapid_language.h"
#include "devices/controllers/abb/rapid/rapid_lexer.h"

namespace seamwright::rapid {
namespace {

class Parser {
  public:
    Parser(const std::string& text, std::string file, bool system)
        : file_(std::move(file)), system_(system), tokens_(tokens_of(text, file_)) {}

    std::unique_ptr<Module> module() {
        auto m = std::make_unique<Module>();
        if (!take("module") && !take("sysmodule")) refuse("a module begins with MODULE");
        m->at = here();
        std::tie(m->name, m->shown) = name("of the module");
        if (take("(")) {
            do {
                static const std::set<std::string> kinds = {"sysmodule", "noview", "nostepin", "viewonly",
                                                            "readonly"};
                if (kinds.count(now().text) == 0) refuse("this is no attribute of a module");
                ++at_;
            } while (take(","));
            need(")");
        }
        while (is("record") || is("alias") || (is("local") && (ahead("record") || ahead("alias")))) type(*m);
        while (is("var") || is("const") || is("pers") ||
               ((is("local") || is("task")) && (ahead("var") || ahead("const") || ahead("pers"))))
            m->data.push_back(declaration(false));
        while (!take("endmodule")) {
            if (is("var") || is("const") || is("pers")) refuse("data are declared before the routines");
            m->routines.push_back(routine());
            m->routines.back()->module = m->name;
        }
        if (now().kind != Token::Kind::end) refuse("something follows ENDMODULE");
        return m;
    }

  private:
    const Token& now() const { return tokens_[at_]; }
    Place here() const { return {file_, now().line}; }
    [[noreturn]] void refuse(const std::string& why) const {
        const Token& t = now();
        const std::string before = t.kind == Token::Kind::end    ? std::string("the end")
                                   : t.kind == Token::Kind::text ? "\"" + t.text + "\""
                                   : t.shown.empty()             ? t.text
                                                                 : t.shown;
        throw LoadError(here(), fmt::format("syntax error at {}: {}", before, why));
    }
    bool is(std::string_view text) const {
        return (now().kind == Token::Kind::word || now().kind == Token::Kind::sign) && now().text == text;
    }
    bool ahead(std::string_view text) const {
        return at_ + 1 < tokens_.size() && tokens_[at_ + 1].kind != Token::Kind::text &&
               tokens_[at_ + 1].text == text;
    }
    bool take(std::string_view text) {
        if (!is(text)) return false;
        ++at_;
        return true;
    }
    void need(std::string_view text) {
        if (!take(text)) refuse(fmt::format("{} is missing", text));
    }
    std::pair<std::string, std::string> name(std::string_view what) {
        if (now().kind != Token::Kind::word) refuse(fmt::format("the name {} is missing", what));
        if (is_reserved_word(now().text))
            refuse(fmt::format("{} is a reserved word and cannot be the name {}", now().shown, what));
        std::pair<std::string, std::string> both{now().text, now().shown};
        ++at_;
        return both;
    }

    void type(Module& m) {
        take("local");
        auto t = std::make_unique<Type>();
        std::vector<std::pair<std::string, std::string>> fields;
        std::string alias;
        if (take("alias")) {
            alias = name("of a type").first;
            t->name = name("of the type").first;
            need(";");
        } else {
            need("record");
            t->name = name("of the record").first;
            t->kind = Type::Kind::record;
            while (!take("endrecord")) {
                std::string of = name("of a type").first;
                fields.emplace_back(std::move(of), name("of a component").first);
                need(";");
            }
        }
        m.types.push_back(std::move(t));
        m.type_fields.push_back(std::move(fields));
        m.type_alias.push_back(std::move(alias));
    }

    std::unique_ptr<Data> declaration(bool in_routine) {
        auto d = std::make_unique<Data>();
        if (in_routine && (is("local") || is("task"))) refuse("a routine's data are neither LOCAL nor TASK");
        if (take("local")) d->scope = Data::Scope::local;
        if (take("task")) d->scope = Data::Scope::task;
        d->at = here();
        if (take("var"))
            d->storage = Storage::variable;
        else if (take("const"))
            d->storage = Storage::constant;
        else if (take("pers"))
            d->storage = Storage::persistent;
        else
            refuse("a declaration wants VAR, CONST or PERS");
        if (in_routine && d->storage == Storage::persistent)
            refuse("a PERS is declared in a module, not in a routine");
        if (d->scope == Data::Scope::task && d->storage == Storage::constant)
            refuse("a CONST cannot be TASK");
        d->type_name = name("of a type").first;
        std::tie(d->name, d->shown) = name("of the data");
        if (take("{")) {
            do d->dims.push_back(expression());
            while (take(","));
            need("}");
            if (d->dims.size() > 3) refuse("an array has at most three dimensions");
        }
        if (take(":=")) d->initial = expression();
        if (d->storage == Storage::constant && !d->initial) refuse("a CONST wants a value");
        if (d->storage == Storage::persistent && d->scope != Data::Scope::global && !d->initial)
            refuse("a LOCAL or TASK PERS wants an initial value");
        need(";");
        return d;
    }

    std::unique_ptr<Routine> routine() {
        auto r = std::make_unique<Routine>();
        r->local = take("local");
        r->at = here();
        std::string_view end;
        if (take("proc")) {
            end = "endproc";
        } else if (take("func")) {
            r->kind = Routine::Kind::function;
            r->type_name = name("of a type").first;
            end = "endfunc";
        } else if (take("trap")) {
            r->kind = Routine::Kind::trap;
            end = "endtrap";
        } else {
            refuse("PROC, FUNC or TRAP is missing");
        }
        std::tie(r->name, r->shown) = name("of the routine");
        if (r->kind != Routine::Kind::trap) parameters(*r);
        if (system_) {
            need(";");
            return r;
        }
        while (is("var") || is("const") || is("pers") || is("local") || is("task"))
            r->data.push_back(declaration(true));
        r->body = block();
        if (take("error")) {
            r->has_handler = true;
            handler_ = true;
            r->handler = block();
            handler_ = false;
        }
        need(end);
        return r;
    }

    void parameters(Routine& r) {
        need("(");
        int choice = 0;
        bool first = true;
        while (!take(")")) {
            const bool alternative = take("|");
            if (alternative && (first || !r.parameters.back().optional))
                refuse("| follows an optional parameter");
            if (!alternative && !first && !is("\\")) need(",");
            Parameter p;
            p.optional = alternative || take("\\");
            p.choice = alternative ? choice : ++choice;
            if (take("inout"))
                p.mode = Parameter::Mode::inout;
            else if (take("var"))
                p.mode = Parameter::Mode::variable;
            else if (take("pers"))
                p.mode = Parameter::Mode::persistent;
            p.type_name = name("of a type").first;
            p.name = name("of a parameter").first;
            if (take("{")) {
                do {
                    need("*");
                    ++p.dims;
                } while (take(","));
                need("}");
            }
            if (p.type_name == "switch" && !p.optional) refuse("a switch is optional");
            r.parameters.push_back(std::move(p));
            first = false;
        }
    }

    Block block() {
        Block b;
        static const std::set<std::string> ends = {"endproc", "endfunc", "endtrap", "endif",   "endwhile",
                                                   "endfor",  "endtest", "else",    "elseif",  "case",
                                                   "default", "error",   "undo",    "backward"};
        while (now().kind != Token::Kind::word || ends.count(now().text) == 0) {
            if (now().kind == Token::Kind::end) refuse("the block is not closed");
            b.push_back(statement());
        }
        if (is("undo") || is("backward")) refuse("the interpreter does not know this handler");
        return b;
    }

    std::unique_ptr<Statement> statement() {
        auto s = std::make_unique<Statement>();
        s->at = here();
        using Kind = Statement::Kind;
        if (is("var") || is("const") || is("pers"))
            refuse("a routine's data are declared before its instructions");
        if (take("if")) {
            branch(*s);
            return s;
        }
        if (take("while")) {
            loop_while(*s);
            return s;
        }
        if (take("for")) {
            loop_for(*s);
            return s;
        }
        if (take("test")) {
            test(*s);
            return s;
        }
        if (take("return")) {
            s->kind = Kind::give_back;
            if (!is(";")) s->value = expression();
        } else if (take("raise")) {
            s->kind = Kind::raise;
            if (!is(";")) s->value = expression();
            if (!s->value && !handler_) refuse("RAISE without a number stands in an error handler");
        } else if (is("retry") || is("trynext")) {
            s->kind = is("retry") ? Kind::retry : Kind::trynext;
            if (!handler_) refuse("it stands in an error handler only");
            ++at_;
        } else if (take("exit")) {
            s->kind = Kind::exit;
        } else if (take("connect")) {
            s->kind = Kind::connect;
            s->target = primary();
            need("with");
            s->name = name("of the trap").first;
        } else {
            if (now().kind != Token::Kind::word || is_reserved_word(now().text))
                refuse("this begins no instruction");
            if (ahead(":=") || ahead("{") || ahead(".")) {
                s->kind = Kind::assign;
                s->target = primary();
                need(":=");
                s->value = expression();
            } else {
                s->kind = Kind::call;
                s->name = name("of the instruction").first;
                if (!is(";")) s->arguments = arguments(";");
            }
        }
        need(";");
        return s;
    }

    void branch(Statement& s) {
        s.kind = Statement::Kind::branch;
        auto condition = expression();
        if (!take("then")) {  // one simple instruction
            Block one;
            if (is("if") || is("while") || is("for") || is("test")) refuse("THEN is missing");
            one.push_back(statement());
            s.branches.emplace_back(std::move(condition), std::move(one));
            return;
        }
        s.branches.emplace_back(std::move(condition), block());
        while (take("elseif")) {
            auto other = expression();
            need("then");
            s.branches.emplace_back(std::move(other), block());
        }
        if ((s.has_otherwise = take("else"))) s.otherwise = block();
        need("endif");
        take(";");
    }

    void loop_while(Statement& s) {
        s.kind = Statement::Kind::loop_while;
        auto condition = expression();
        need("do");
        s.branches.emplace_back(std::move(condition), block());
        need("endwhile");
        take(";");
    }

    void loop_for(Statement& s) {
        s.kind = Statement::Kind::loop_for;
        s.name = name("of the loop's variable").first;
        need("from");
        s.value = expression();
        need("to");
        s.until = expression();
        if (take("step")) s.step = expression();
        need("do");
        s.otherwise = block();
        need("endfor");
        take(";");
    }

    void test(Statement& s) {
        s.kind = Statement::Kind::test;
        s.value = expression();
        while (take("case")) {
            std::vector<ExprPtr> values;
            do values.push_back(expression());
            while (take(","));
            need(":");
            s.cases.emplace_back(std::move(values), block());
        }
        if ((s.has_otherwise = take("default"))) {
            need(":");
            s.otherwise = block();
        }
        need("endtest");
        take(";");
    }

    // Up to `end`, which stays.
    std::vector<Argument> arguments(std::string_view end) {
        std::vector<Argument> list;
        for (bool first = true; !is(end); first = false) {
            if (!first && !is("\\")) need(",");
            Argument a;
            a.at = here();
            if (take("\\")) {
                a.name = name("of an argument").first;
                if (take(":=")) a.value = expression();
            } else {
                a.value = expression();
            }
            list.push_back(std::move(a));
        }
        return list;
    }

    ExprPtr make(Expr::Kind kind, std::string text = {}) const {
        auto e = std::make_unique<Expr>();
        e->kind = kind;
        e->at = here();
        e->text = std::move(text);
        return e;
    }
    ExprPtr binary(ExprPtr left, ExprPtr right, std::string sign) const {
        auto e = make(Expr::Kind::binary, std::move(sign));
        e->parts.push_back(std::move(left));
        e->parts.push_back(std::move(right));
        return e;
    }
    // The five levels of the kernel's grammar; NOT begins an expression and binds weakest.
    ExprPtr expression() {
        if (++depth_ > 60) refuse("nested too deeply");
        ExprPtr e;
        if (take("not")) {
            e = make(Expr::Kind::unary, "not");
            e->parts.push_back(logical_term());
        } else {
            e = logical_term();
        }
        while (is("or") || is("xor")) {
            std::string sign = now().text;
            ++at_;
            e = binary(std::move(e), logical_term(), sign);
        }
        --depth_;
        return e;
    }
    ExprPtr logical_term() {
        auto e = relation();
        while (take("and")) e = binary(std::move(e), relation(), "and");
        return e;
    }
    ExprPtr relation() {
        auto e = simple();
        for (const char* sign : {"=", "<>", "<", ">", "<=", ">="})
            if (take(sign)) return binary(std::move(e), simple(), sign);
        return e;
    }
    ExprPtr simple() {
        ExprPtr e;
        if (take("-")) {
            e = make(Expr::Kind::unary, "-");
            e->parts.push_back(term());
        } else {
            take("+");
            e = term();
        }
        while (is("+") || is("-")) {
            std::string sign = now().text;
            ++at_;
            e = binary(std::move(e), term(), sign);
        }
        return e;
    }
    ExprPtr term() {
        auto e = primary();
        while (is("*") || is("/") || is("div") || is("mod")) {
            std::string sign = now().text;
            ++at_;
            e = binary(std::move(e), primary(), sign);
        }
        return e;
    }
    ExprPtr primary() {
        if (now().kind == Token::Kind::number) {
            auto e = make(Expr::Kind::number);
            e->number = now().number;
            ++at_;
            return e;
        }
        if (now().kind == Token::Kind::text) {
            auto e = make(Expr::Kind::text, now().text);
            ++at_;
            return e;
        }
        if (is("true") || is("false")) {
            auto e = make(Expr::Kind::truth);
            e->number = is("true") ? 1 : 0;
            ++at_;
            return e;
        }
        if (take("(")) {
            auto e = expression();
            need(")");
            return e;
        }
        if (is("[")) {
            auto e = make(Expr::Kind::aggregate);
            ++at_;
            do e->parts.push_back(expression());
            while (take(","));
            need("]");
            return e;
        }
        if (now().kind != Token::Kind::word || is_reserved_word(now().text))
            refuse("an expression is missing");
        auto e = make(Expr::Kind::name, now().text);
        ++at_;
        if (take("(")) {
            e->kind = Expr::Kind::call;
            e->arguments = arguments(")");
            need(")");
            return e;
        }
        for (;;) {
            if (take("{")) {
                auto of = make(Expr::Kind::index);
                of->parts.push_back(std::move(e));
                do of->parts.push_back(expression());
                while (take(","));
                need("}");
                e = std::move(of);
            } else if (take(".")) {
                auto of = make(Expr::Kind::component);
                of->text = name("of a component").first;
                of->parts.push_back(std::move(e));
                e = std::move(of);
            } else {
                return e;
            }
        }
    }

    const std::string file_;
    const bool system_;
    const std::vector<Token> tokens_;
    std::size_t at_ = 0;
    int depth_ = 0;
    bool handler_ = false;
};

}  // namespace

std::unique_ptr<Module> parse_module(const std::string& text, const std::string& file, bool system) {
    return Parser(text, file, system).module();
}

}  // namespace seamwright::rapid
