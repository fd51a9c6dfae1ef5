#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>

#include "devices/controllers/ur/script/builtins.h"
#include "devices/controllers/ur/script/compiler.h"

namespace seamwright::urscript {

void Compiler::expression() {
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

void Compiler::negation() {
    if (take("not")) {
        negation();
        emit(Code::logical_not);
        return;
    }
    comparison();
}

void Compiler::comparison() {
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

void Compiler::sum() {
    product();
    while (!failed_ && (is("+") || is("-"))) {
        const Code code = is("+") ? Code::add : Code::subtract;
        next();
        product();
        emit(code);
    }
}

void Compiler::product() {
    sign();
    while (!failed_ && (is("*") || is("/") || is("%"))) {
        const Code code = is("*") ? Code::multiply : is("/") ? Code::divide : Code::remainder;
        next();
        sign();
        emit(code);
    }
}

void Compiler::sign() {
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

void Compiler::primary() {
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

int Compiler::elements() {
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

void Compiler::named() {
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

void Compiler::call(const std::string& word) {
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

}  // namespace seamwright::urscript
