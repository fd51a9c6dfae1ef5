#include "devices/exchange/json_fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "devices/exchange/shown_text.h"

namespace seamwright {
namespace {

const char* type_name(const nlohmann::json& json) {
    switch (json.type()) {
        case nlohmann::json::value_t::null:
            return "null";
        case nlohmann::json::value_t::object:
            return "an object";
        case nlohmann::json::value_t::array:
            return "an array";
        case nlohmann::json::value_t::string:
            return "a text";
        case nlohmann::json::value_t::boolean:
            return "true/false";
        default:
            return "a number";
    }
}

// Builds the document from the parser's events and ends the parse at the first thing that no document of ours
// has, before memory is taken for what follows.
class DocumentBuilder final : public nlohmann::json_sax<nlohmann::json> {
  public:
    nlohmann::json document;
    std::string syntax, twice;  // what is wrong; empty: nothing
    bool too_deep = false;

    bool null() override { return put(nullptr); }
    bool boolean(bool value) override { return put(value); }
    bool number_integer(number_integer_t value) override { return put(value); }
    bool number_unsigned(number_unsigned_t value) override { return put(value); }
    bool number_float(number_float_t value, const string_t&) override { return put(value); }
    bool string(string_t& value) override { return put(std::move(value)); }
    bool binary(binary_t&) override { return false; }  // not in JSON text
    bool start_object(std::size_t) override { return open(nlohmann::json::object()); }
    bool end_object() override { return close(); }
    bool start_array(std::size_t) override { return open(nlohmann::json::array()); }
    bool end_array() override { return close(); }
    bool key(string_t& name) override {
        if (twice.empty() && open_.back()->contains(name)) twice = name;
        key_ = std::move(name);
        return true;
    }
    bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception& e) override {
        // "[json.exception.parse_error.101] parse error at line 1, column 4: ..." without the library's own
        // tag.
        syntax = e.what();
        if (const auto tag = syntax.find("] "); tag != std::string::npos) syntax.erase(0, tag + 2);
        return false;
    }

  private:
    template <class Value>
    nlohmann::json& add(Value&& value) {
        if (open_.empty()) return document = std::forward<Value>(value);
        nlohmann::json& in = *open_.back();
        if (in.is_array()) return in.emplace_back(std::forward<Value>(value));
        return in[key_] = std::forward<Value>(value);
    }
    template <class Value>
    bool put(Value&& value) {
        add(std::forward<Value>(value));
        return true;
    }
    bool open(nlohmann::json container) {
        too_deep = open_.size() >= kDeepestJson;
        if (!too_deep) open_.push_back(&add(std::move(container)));
        return !too_deep;
    }
    bool close() {
        open_.pop_back();
        return true;
    }

    std::vector<nlohmann::json*> open_;  // each the last entry of the one before, so that none moves
    std::string key_;
};

}  // namespace

Expected<nlohmann::json> parse_json(std::string_view text, const std::string& where) {
    if (text.size() > kTextFileLimit)
        return input_error(Text("the JSON is longer than {} MiB", kTextFileLimit >> 20), where);
    if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
    if (is_utf16(text)) return input_error("the text is UTF-16", where, "save it as UTF-8 or plain ASCII");
    DocumentBuilder builder;
    const bool whole = nlohmann::json::sax_parse(text.begin(), text.end(), &builder);
    if (builder.too_deep) return input_error(Text("the JSON is nested deeper than {}", kDeepestJson), where);
    if (text.find_first_not_of(" \t\r\n") == std::string_view::npos) builder.syntax = "the text is empty";
    // The library's words quote the bytes it read last.
    if (!whole)
        return input_error(Text("is no JSON ({})", shown_text(builder.syntax, builder.syntax.size())), where);
    if (!builder.twice.empty())
        return input_error(Text("the key \"{}\" is given twice in one object", builder.twice), where);
    return std::move(builder.document);
}

std::size_t json_depth(const nlohmann::json& json) {
    const auto depth = [](const auto& self, const nlohmann::json& value, std::size_t above) -> std::size_t {
        if (!value.is_structured() || above > kDeepestJson) return above;
        std::size_t deepest = above + 1;
        for (const nlohmann::json& item : value) deepest = std::max(deepest, self(self, item, above + 1));
        return deepest;
    };
    return depth(depth, json, 0);
}

Expected<nlohmann::json> read_json_file(const std::filesystem::path& path, std::size_t limit_bytes) {
    SEAM_TRY(auto text, read_text_file(path, limit_bytes));
    return parse_json(text, path.string());
}

std::string json_path(const std::string& where, const std::string& key) {
    return where.empty() ? key : where + "." + key;
}
std::string json_path(const std::string& where, std::size_t index) {
    return fmt::format("{}[{}]", where, index);
}

Expected<void> only_fields(const nlohmann::json& json, std::initializer_list<std::string_view> known,
                           const std::string& where) {
    return only_fields(json, std::vector<std::string_view>(known), where);
}

Expected<void> only_fields(const nlohmann::json& json, const std::vector<std::string_view>& known,
                           const std::string& where) {
    if (!json.is_object()) return input_error(Text("must be an object, not {}", type_name(json)), where);
    if (known.empty()) return {};
    for (const auto& [key, value] : json.items()) {
        if (std::find(known.begin(), known.end(), key) != known.end()) continue;
        std::string list;
        for (std::string_view k : known) list += (list.empty() ? "" : ", ") + std::string(k);
        return input_error("is not a known field", json_path(where, key), Text("known are {}", list));
    }
    return {};
}

Expected<double> as_number(const nlohmann::json& value, const std::string& where) {
    if (!value.is_number()) return input_error(Text("must be a number, not {}", type_name(value)), where);
    const double number = value.get<double>();
    if (!std::isfinite(number)) return input_error("must be finite", where);
    return number;
}

Expected<const nlohmann::json*> json_field(const nlohmann::json& json, const std::string& key,
                                           const std::string& where) {
    if (!json.is_object()) return input_error(Text("must be an object, not {}", type_name(json)), where);
    const auto it = json.find(key);
    if (it == json.end()) return input_error("is missing", json_path(where, key));
    return &*it;
}

Expected<const nlohmann::json*> json_array(const nlohmann::json& json, const std::string& key,
                                           const std::string& where) {
    const auto field = json_field(json, key, where);
    if (!field || (*field)->is_array()) return field;
    return input_error(Text("must be an array, not {}", type_name(**field)), json_path(where, key));
}

Expected<double> json_number(const nlohmann::json& json, const std::string& key, const std::string& where) {
    SEAM_TRY(const auto field, json_field(json, key, where));
    return as_number(*field, json_path(where, key));
}

Expected<std::string> json_string(const nlohmann::json& json, const std::string& key,
                                  const std::string& where) {
    SEAM_TRY(const auto field, json_field(json, key, where));
    if (!field->is_string()) {
        return input_error(Text("must be a text, not {}", type_name(*field)), json_path(where, key));
    }
    return field->get<std::string>();
}

Expected<double> json_number_or(const nlohmann::json& json, const std::string& key, double otherwise,
                                const std::string& where) {
    return json.is_object() && !json.contains(key) ? Expected<double>(otherwise)
                                                   : json_number(json, key, where);
}

Expected<bool> json_bool_or(const nlohmann::json& json, const std::string& key, bool otherwise,
                            const std::string& where) {
    if (json.is_object() && !json.contains(key)) return otherwise;
    SEAM_TRY(const auto field, json_field(json, key, where));
    if (!field->is_boolean()) {
        return input_error(Text("must be true or false, not {}", type_name(*field)), json_path(where, key));
    }
    return field->get<bool>();
}

Expected<std::string> json_string_or(const nlohmann::json& json, const std::string& key,
                                     const std::string& otherwise, const std::string& where) {
    return json.is_object() && !json.contains(key) ? Expected<std::string>(otherwise)
                                                   : json_string(json, key, where);
}

Expected<std::vector<double>> as_numbers(const nlohmann::json& json, std::size_t size,
                                         const std::string& where) {
    if (!json.is_array())
        return input_error(Text("must be an array of numbers, not {}", type_name(json)), where);
    if (size != 0 && json.size() != size) {
        return input_error(Text("has {} entries instead of {}", json.size(), size), where);
    }
    std::vector<double> numbers;
    numbers.reserve(json.size());
    for (std::size_t i = 0; i < json.size(); ++i) {
        SEAM_TRY(const auto number, as_number(json[i], json_path(where, i)));
        numbers.push_back(number);
    }
    return numbers;
}

Expected<Eigen::Vector2d> json_vector2(const nlohmann::json& json, const std::string& key,
                                       const std::string& where) {
    SEAM_TRY(const auto field, json_field(json, key, where));
    SEAM_TRY(const auto numbers, as_numbers(*field, 2, json_path(where, key)));
    return Eigen::Vector2d(numbers[0], numbers[1]);
}

Expected<Eigen::Vector3d> json_vector3(const nlohmann::json& json, const std::string& key,
                                       const std::string& where) {
    SEAM_TRY(const auto field, json_field(json, key, where));
    SEAM_TRY(const auto numbers, as_numbers(*field, 3, json_path(where, key)));
    return Eigen::Vector3d(numbers[0], numbers[1], numbers[2]);
}

}  // namespace seamwright
