#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "devices/controllers/ur/script/builtins.h"
#include "devices/controllers/ur/script/lexer.h"
#include "devices/controllers/ur/script/program.h"

namespace seamwright::urscript {
namespace {

using Kind = Token::Kind;

// One pass over the tokens. A failure ends it: every step after the first error does nothing.
class Compiler {
  public:
    Compiler(std::vector<Token> tokens, Program& program) : tokens_(std::move(tokens)), program_(program) {}

    std::optional<std::pair<std::string, int>> run() {
        program_.functions.push_back({"the program", false, 0, {}, {}});
        scopes_.push_back({0, {}, {}});
        block({});
        if (!failed_ && now().kind != Kind::end) fail("\"" + now().text + "\" closes no block");
        emit_return();
        return failed_;
    }

  private:
    struct Loop {
        int begin;
        std::vector<std::size_t> breaks;
    };
    struct Scope {  // a function that is being written
        int function;
        std::map<std::string, int> functions;  // defined in it
        std::vector<Loop> loops;
    };

    const Token& now() const { return tokens_[at_]; }
    void next() {
        if (at_ + 1 < tokens_.size()) ++at_;
    }
    void fail(std::string what) { fail_at(std::move(what), now().line); }
    void fail_at(std::string what, int line) {
        if (!failed_) failed_ = std::pair(std::move(what), line);
        at_ = tokens_.size() - 1;
    }
    bool is(std::string_view sign) const {
        return (now().kind == Kind::sign || now().kind == Kind::keyword) && now().text == sign;
    }
    bool take(std::string_view sign) {
        if (!is(sign)) return false;
        next();
        return true;
    }
    void expect(std::string_view sign) {
        if (!take(sign)) fail(fmt::format("\"{}\" is missing before \"{}\"", sign, shown()));
    }
    std::string shown() const {
        return now().kind == Kind::newline ? "the end of the line"
               : now().kind == Kind::end   ? "the end of the program"
                                           : now().text;
    }
    void end_of_line() {
        if (now().kind != Kind::newline) return fail("\"" + shown() + "\" stands behind a whole statement");
        next();
    }
    std::string name(std::string_view what) {
        if (now().kind != Kind::name) {
            fail(fmt::format("\"{}\" is no name of {}", shown(), what));
            return {};
        }
        std::string word = now().text;
        next();
        return word;
    }

    Function& function() { return program_.functions[static_cast<std::size_t>(scopes_.back().function)]; }
    bool first_level() const { return scopes_.size() == 1; }
    std::size_t emit(Code code, int a = 0, int b = 0) {
        function().code.push_back({code, a, b, now().line});
        return function().code.size() - 1;
    }
    int here() { return static_cast<int>(function().code.size()); }
    void land(std::size_t jump) { function().code[jump].a = here(); }
    int constant(Value value) {
        program_.constants.push_back(std::move(value));
        return static_cast<int>(program_.constants.size() - 1);
    }
    void emit_return() {
        emit(Code::constant, constant({}));
        emit(Code::give_back);
    }
    static std::optional<int> find(const std::vector<std::string>& names, const std::string& name) {
        const auto it = std::find(names.begin(), names.end(), name);
        if (it == names.end()) return std::nullopt;
        return static_cast<int>(it - names.begin());
    }
    std::optional<int> find_function(const std::string& name) const {
        for (auto scope = scopes_.rbegin(); scope != scopes_.rend(); ++scope)
            if (const auto it = scope->functions.find(name); it != scope->functions.end()) return it->second;
        return std::nullopt;
    }
    bool may_name(const std::string& word, bool variable) {
        if (failed_) return false;
        if (is_function_of_the_language(word) || find_builtin(word))
            fail(fmt::format("\"{}\" is a function of the language", word));
        else if (find_function(word))
            fail(fmt::format("\"{}\" is a function already", word));
        else if (!variable && find(program_.globals, word))
            fail(fmt::format("\"{}\" is a variable already", word));
        return !failed_;
    }

    // Up to one of `closers`, which stays.
    void block(const std::vector<std::string_view>& closers) {
        while (!failed_) {
            if (now().kind == Kind::newline) {
                next();
                continue;
            }
            if (now().kind == Kind::end) {
                if (!closers.empty()) fail("a block has no end");
                return;
            }
            if (std::any_of(closers.begin(), closers.end(), [&](auto c) { return is(c); })) return;
            if (is("end") || is("else") || is("elif")) return;
            statement();
        }
    }

    void statement() {
        if (take("def")) return definition(false);
        if (take("thread")) return definition(true);
        if (take("if")) return conditional();
        if (take("while")) return loop();
        if (take("return")) {
            if (now().kind == Kind::newline)
                emit(Code::constant, constant({}));
            else
                expression();
            emit(Code::give_back);
        } else if (take("break")) {
            if (scopes_.back().loops.empty()) return fail("break stands outside a loop");
            scopes_.back().loops.back().breaks.push_back(emit(Code::jump));
        } else if (take("continue")) {
            if (scopes_.back().loops.empty()) return fail("continue stands outside a loop");
            emit(Code::jump, scopes_.back().loops.back().begin);
        } else if (take("pass")) {
        } else if (take("halt")) {
            emit(Code::halt_program);
        } else if (take("enter_critical")) {
            emit(Code::enter_critical);
        } else if (take("exit_critical")) {
            emit(Code::exit_critical);
        } else if (take("join")) {
            expression();
            emit(Code::join_thread);
        } else if (take("kill")) {
            expression();
            emit(Code::kill_thread);
        } else if (take("global")) {
            const std::string word = name("a variable");
            expect("=");
            expression();
            store(word, true, false);
        } else if (take("local")) {
            const std::string word = name("a variable");
            expect("=");
            expression();
            store(word, false, true);
        } else if (is("run")) {
            expression();
            emit(Code::drop);
        } else if (now().kind == Kind::name) {
            assignment_or_call();
        } else {
            return fail("\"" + shown() + "\" begins no statement");
        }
        if (!failed_) end_of_line();
    }

    void assignment_or_call() {
        const Token& after = tokens_[at_ + 1];
        if (after.kind == Kind::sign && after.text == "=") {
            const std::string word = name("a variable");
            next();
            expression();
            return store(word, false, false);
        }
        if (after.kind == Kind::sign && after.text == "[") {
            const std::string word = name("a variable");
            next();
            expression();
            expect("]");
            expect("=");
            expression();
            if (const auto local = first_level() ? std::nullopt : find(function().locals, word))
                emit(Code::store_element, *local, 0);
            else if (const auto global = find(program_.globals, word))
                emit(Code::store_element, *global, 1);
            else
                fail(fmt::format("\"{}\" is used before it has a value", word));
            return;
        }
        if (!(after.kind == Kind::sign && after.text == "("))
            return fail(fmt::format("\"{}\" alone is no statement", now().text));
        expression();
        emit(Code::drop);
    }

    // Free names are the global of that name where there is one; on the first level all are global.
    void store(const std::string& word, bool global, bool local) {
        if (!may_name(word, true)) return;
        if (first_level()) global = true;
        if (!global) {
            const auto mine = find(function().locals, word);
            if (mine || local || !find(program_.globals, word)) {
                if (!mine) function().locals.push_back(word);
                emit(Code::store_local, mine.value_or(static_cast<int>(function().locals.size()) - 1));
                return;
            }
        } else if (!first_level() && find(function().locals, word)) {
            return fail(fmt::format("\"{}\" is local already", word));
        }
        auto slot = find(program_.globals, word);
        if (!slot) {
            program_.globals.push_back(word);
            slot = static_cast<int>(program_.globals.size()) - 1;
        }
        emit(Code::store_global, *slot);
    }

    void definition(bool thread) {
        const std::string word = name(thread ? "a thread" : "a function");
        if (!may_name(word, false)) return;
        Function made{word, thread, 0, {}, {}};
        expect("(");
        while (!failed_ && !is(")")) {
            const std::string parameter = name("a parameter");
            if (find(made.locals, parameter)) fail(fmt::format("\"{}\" is a parameter twice", parameter));
            if (!may_name(parameter, true)) return;
            made.locals.push_back(parameter);
            if (!is(")")) expect(",");
        }
        expect(")");
        expect(":");
        if (!failed_) end_of_line();
        if (thread && !made.locals.empty()) return fail("a thread takes no parameters");
        made.parameters = made.locals.size();
        const int number = static_cast<int>(program_.functions.size());
        program_.functions.push_back(std::move(made));
        scopes_.back().functions[word] = number;
        scopes_.push_back({number, {}, {}});
        block({"end"});
        expect("end");
        emit_return();
        scopes_.pop_back();
        if (!failed_) end_of_line();
    }

    void condition() {
        expression();
        expect(":");
        if (!failed_) end_of_line();
    }

    void conditional() {
        std::vector<std::size_t> ends;
        condition();
        std::size_t skip = emit(Code::jump_if_not);
        block({"elif", "else", "end"});
        while (!failed_ && take("elif")) {
            ends.push_back(emit(Code::jump));
            land(skip);
            condition();
            skip = emit(Code::jump_if_not);
            block({"elif", "else", "end"});
        }
        if (!failed_ && take("else")) {
            expect(":");
            if (!failed_) end_of_line();
            ends.push_back(emit(Code::jump));
            land(skip);
            block({"end"});
        } else if (!failed_) {
            land(skip);
        }
        expect("end");
        if (failed_) return;
        for (const std::size_t jump : ends) land(jump);
        end_of_line();
    }

    void loop() {
        scopes_.back().loops.push_back({here(), {}});
        condition();
        const std::size_t out = emit(Code::jump_if_not);
        block({"end"});
        expect("end");
        if (failed_) return;
        emit(Code::jump, scopes_.back().loops.back().begin);
        land(out);
        for (const std::size_t jump : scopes_.back().loops.back().breaks) land(jump);
        scopes_.back().loops.pop_back();
        end_of_line();
    }

    // ---- expressions, weakest first
    void expression() {
        negation();
        while (!failed_ && (is("or") || is("and") || is("xor"))) {
            const Code code = is("or") ? Code::logical_or : is("and") ? Code::logical_and : Code::logical_xor;
            // Without parentheses a reader and a controller may take them in another order.
            if (mixed_ && *mixed_ != code) return fail("and, or and xor need parentheses when mixed");
            mixed_ = code;
            next();
            negation();
            emit(code);
        }
        mixed_.reset();
    }
    void negation() {
        if (take("not")) {
            negation();
            emit(Code::logical_not);
            return;
        }
        comparison();
    }
    void comparison() {
        sum();
        static const std::map<std::string, Code, std::less<>> codes = {
            {"==", Code::equal},  {"!=", Code::unequal},    {"<", Code::less},
            {">", Code::greater}, {"<=", Code::less_equal}, {">=", Code::greater_equal}};
        if (failed_ || now().kind != Kind::sign || !codes.contains(now().text)) return;
        const Code code = codes.at(now().text);
        next();
        sum();
        emit(code);
        if (!failed_ && now().kind == Kind::sign && codes.contains(now().text))
            fail("URScript has no chains of comparisons");
    }
    void sum() {
        product();
        while (!failed_ && (is("+") || is("-"))) {
            const Code code = is("+") ? Code::add : Code::subtract;
            next();
            product();
            emit(code);
        }
    }
    void product() {
        sign();
        while (!failed_ && (is("*") || is("/") || is("%"))) {
            const Code code = is("*") ? Code::multiply : is("/") ? Code::divide : Code::remainder;
            next();
            sign();
            emit(code);
        }
    }
    void sign() {
        if (take("-")) {
            if (now().kind == Kind::number && now().text == "2147483648") {
                emit(Code::constant, constant({std::int32_t{-2147483647 - 1}}));
                return next();
            }
            sign();
            emit(Code::negate);
            return;
        }
        primary();
        while (!failed_ && take("[")) {
            const auto held = std::exchange(mixed_, std::nullopt);
            expression();
            mixed_ = held;
            expect("]");
            emit(Code::index);
        }
    }
    void primary() {
        const auto held = std::exchange(mixed_, std::nullopt);
        if (now().kind == Kind::number || now().kind == Kind::text) {
            if (now().text == "2147483648") return fail("2147483648 is beyond 32 bits");
            emit(Code::constant, constant(now().value));
            next();
        } else if (take("(")) {
            expression();
            expect(")");
        } else if (take("[")) {
            emit(Code::make_list, elements());
        } else if (take("run")) {
            const std::string word = name("a thread");
            const auto made = find_function(word);
            if (!failed_ && (!made || !program_.functions[static_cast<std::size_t>(*made)].thread))
                return fail(fmt::format("\"{}\" is no thread", word));
            expect("(");
            expect(")");
            if (!failed_) emit(Code::run_thread, *made);
        } else if (now().kind == Kind::name) {
            named();
        } else {
            fail("\"" + shown() + "\" is no value");
        }
        mixed_ = held;
    }
    int elements() {
        int count = 0;
        if (is("]")) fail("URScript has no empty list");
        while (!failed_ && !is("]")) {
            expression();
            ++count;
            if (!is("]")) expect(",");
        }
        expect("]");
        return count;
    }
    void named() {
        const std::string word = name("a value");
        if (word == "p" && take("[")) {
            if (elements() != 6) return fail("a pose has six numbers");
            emit(Code::make_pose);
            return;
        }
        if (take("(")) return call(word);
        if (const auto local = first_level() ? std::nullopt : find(function().locals, word))
            emit(Code::load_local, *local);
        else if (const auto global = find(program_.globals, word))
            emit(Code::load_global, *global);
        else
            fail(fmt::format("\"{}\" is used before it has a value", word));
    }
    void call(const std::string& word) {
        const auto own = find_function(word);
        const auto builtin = find_builtin(word);
        if (!own && !builtin)
            return fail(is_function_of_the_language(word)
                            ? fmt::format("the interpreter does not have {}()", word)
                            : fmt::format("there is no function {}() above this line", word));
        if (own) {
            const Function& called = program_.functions[static_cast<std::size_t>(*own)];
            if (called.thread) return fail(fmt::format("{}() is a thread: run it", word));
            const std::size_t wanted = called.parameters;
            std::size_t given = 0;
            while (!failed_ && !is(")")) {
                expression();
                ++given;
                if (!is(")")) expect(",");
            }
            expect(")");
            if (!failed_ && given != wanted)
                return fail(fmt::format("{}() takes {} arguments, not {}", word, wanted, given));
            emit(Code::call, *own, static_cast<int>(given));
            return;
        }
        // Arguments of the language's functions may be named; what is left out gets no value. Each is
        // written in its parameter's place, so named ones come in the parameters' order.
        const Builtin& called = builtins()[static_cast<std::size_t>(*builtin)];
        std::size_t place = 0;
        while (!failed_ && !is(")")) {
            std::size_t to = place;
            const Token& after = tokens_[at_ + 1];
            if (now().kind == Kind::name && after.kind == Kind::sign && after.text == "=") {
                const auto it = std::find(called.parameters.begin(), called.parameters.end(), now().text);
                if (it == called.parameters.end())
                    return fail(fmt::format("{}() has no argument \"{}\"", word, now().text));
                to = static_cast<std::size_t>(it - called.parameters.begin());
                if (to < place)
                    return fail(fmt::format("argument \"{}\" of {}() stands out of order", now().text, word));
                next();
                next();
            }
            if (to >= called.parameters.size())
                return fail(fmt::format("{}() takes at most {} arguments", word, called.parameters.size()));
            for (; place < to; ++place) {
                if (place < called.required)
                    return fail(fmt::format("{}() needs \"{}\"", word, called.parameters[place]));
                emit(Code::constant, constant({}));
            }
            expression();
            ++place;
            if (!is(")")) expect(",");
        }
        expect(")");
        if (failed_) return;
        if (place < called.required)
            return fail(fmt::format("{}() needs \"{}\"", word, called.parameters[place]));
        for (; place < called.parameters.size(); ++place) emit(Code::constant, constant({}));
        emit(Code::call_builtin, *builtin);
    }

    const std::vector<Token> tokens_;
    Program& program_;
    std::size_t at_ = 0;
    std::vector<Scope> scopes_;
    std::optional<Code> mixed_;  // the connective of the expression being read
    std::optional<std::pair<std::string, int>> failed_;
};

}  // namespace

std::string Program::where(int line) const {
    for (auto source = sources.rbegin(); source != sources.rend(); ++source)
        if (line >= source->second)
            return fmt::format("{} line {}", source->first, line - source->second + 1);
    return fmt::format("line {}", line);
}

Expected<Program> compile(const std::vector<Source>& sources) {
    Program program;
    std::vector<Token> tokens;
    int first = 1;
    for (const Source& source : sources) {
        program.sources.emplace_back(source.name, first);
        auto read = tokens_of(source.text);
        if (!read) {
            Error error = read.error();
            error.where = joined(source.name, " ", error.where);
            return tl::unexpected(error);
        }
        read->pop_back();  // the end
        for (Token& token : *read) {
            token.line += first - 1;
            tokens.push_back(std::move(token));
        }
        first += 1 + static_cast<int>(std::count(source.text.begin(), source.text.end(), '\n'));
    }
    tokens.push_back({Token::Kind::end, "", {}, first});
    if (const auto failed = Compiler(std::move(tokens), program).run())
        return input_error(failed->first, program.where(failed->second));
    return program;
}

}  // namespace seamwright::urscript
