#include "devices/controllers/kuka/krl/krl_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace seamwright::krl {

namespace {

ExpressionPtr literal(Value value) {
    auto e = std::make_shared<Expression>();
    e->value = std::move(value);
    return e;
}

}  // namespace

ExpressionPtr place_or_call(Reader& r) {
    auto e = std::make_shared<Expression>();
    const Token name = r.take();
    if (name.kind != TokenKind::name) throw KrlError(fmt::format("{} is no variable", name.text));
    e->name = name.text;
    if (r.accept("(")) {
        e->kind = Expression::Kind::call;
        while (!r.accept(")")) {
            e->parts.push_back(r.is(",") || r.is(")") ? nullptr : expression(r));
            if (!r.is(")")) r.expect(",");
        }
        return e;
    }
    e->kind = Expression::Kind::place;
    if (is_reserved(name.text))
        throw KrlError(fmt::format("{} stands where a variable is expected", name.text));
    if (r.accept("[")) {
        for (;;) {
            if (r.accept("]")) {
                e->row = true;
                break;
            }
            e->parts.push_back(expression(r));
            if (r.accept("]")) break;
            r.expect(",");
        }
    }
    if (r.accept(".")) e->component = r.take().text;
    return e;
}

namespace {

ExpressionPtr primary(Reader& r) {
    const Token& t = r.peek();
    switch (t.kind) {
        case TokenKind::integer:
            return literal(Value::integer(r.take().number));
        case TokenKind::real:
            return literal(Value::real(r.take().number));
        case TokenKind::string:
            return literal(Value::string_of(r.take().text));
        case TokenKind::enumeration:
            return literal(Value::name(r.take().text));
        case TokenKind::end:
            throw KrlError("a value is expected at the end of the line");
        default:
            break;
    }
    if (r.accept("TRUE")) return literal(Value::boolean(true));
    if (r.accept("FALSE")) return literal(Value::boolean(false));
    if (r.accept("(")) {
        auto e = expression(r);
        r.expect(")");
        return e;
    }
    if (r.accept("{")) {
        auto e = std::make_shared<Expression>();
        e->kind = Expression::Kind::aggregate;
        if (r.peek(1).text == ":") {  // {FRAME: X 1.0, ...}
            e->name = r.take().text;
            r.take();
        }
        do {
            const Token field = r.take();
            if (field.kind != TokenKind::name) throw KrlError(fmt::format("{} is no component", field.text));
            e->fields.emplace_back(field.text, expression(r));
        } while (r.accept(","));
        r.expect("}");
        return e;
    }
    return place_or_call(r);
}

ExpressionPtr joined(std::string op, ExpressionPtr a, ExpressionPtr b) {
    auto e = std::make_shared<Expression>();
    e->kind = b ? Expression::Kind::binary : Expression::Kind::unary;
    e->name = std::move(op);
    e->parts.push_back(std::move(a));
    if (b) e->parts.push_back(std::move(b));
    return e;
}

// KRL's precedence: NOT; the geometric operator; * /; + -; AND; EXOR; OR; comparisons last.
ExpressionPtr unary(Reader& r) {
    if (r.accept("NOT")) return joined("NOT", unary(r), nullptr);
    if (r.accept("-")) return joined("-", unary(r), nullptr);
    if (r.accept("+")) return unary(r);
    return primary(r);
}
ExpressionPtr level(Reader& r, std::size_t depth) {
    static const std::vector<std::vector<std::string>> operators = {
        {"==", "<>", "<=", ">=", "<", ">"}, {"OR"}, {"EXOR"}, {"AND"}, {"+", "-"}, {"*", "/"}, {":"}};
    if (depth == operators.size()) return unary(r);
    auto left = level(r, depth + 1);
    for (;;) {
        const auto& now = operators[depth];
        const auto op = std::find_if(now.begin(), now.end(), [&](const std::string& o) { return r.is(o); });
        if (op == now.end()) return left;
        r.take();
        left = joined(*op, left, level(r, depth + 1));
    }
}
}  // namespace

ExpressionPtr expression(Reader& r) {
    return level(r, 0);
}

}  // namespace seamwright::krl
