#include "devices/controllers/ur/script/compiler.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "devices/controllers/ur/script/builtins.h"

namespace seamwright::urscript {

std::optional<std::pair<std::string, int>> Compiler::run() {
    program_.functions.push_back({"the program", false, 0, {}, {}});
    scopes_.push_back({0, {}, {}});
    block({});
    if (!failed_ && now().kind != Kind::end) fail("\"" + now().text + "\" closes no block");
    emit_return();
    return failed_;
}

bool Compiler::may_name(const std::string& word, bool variable) {
    if (failed_) return false;
    if (is_function_of_the_language(word) || find_builtin(word))
        fail(fmt::format("\"{}\" is a function of the language", word));
    else if (find_function(word))
        fail(fmt::format("\"{}\" is a function already", word));
    else if (!variable && find(program_.globals, word))
        fail(fmt::format("\"{}\" is a variable already", word));
    return !failed_;
}

void Compiler::block(const std::vector<std::string_view>& closers) {
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

void Compiler::statement() {
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

void Compiler::assignment_or_call() {
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

void Compiler::store(const std::string& word, bool global, bool local) {
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

void Compiler::definition(bool thread) {
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

void Compiler::condition() {
    expression();
    expect(":");
    if (!failed_) end_of_line();
}

void Compiler::conditional() {
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

void Compiler::loop() {
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
