#pragma once
// One description of each stored type, read and written by the same function: describe(archive, value) names
// every field once, so that what is written and what is read cannot drift apart.
//
// Form: objects with the C++ field names; poses {"xyz":[mm],"abc":[deg],"matrix":[16 row-major]} (read back
// from the matrix, bit for bit; the house's other forms are read too); enums as words that are frozen here,
// apart from what screens print; doubles exact (shortest text that reads back equal), "nan", "inf", "-inf"
// where not finite. Reading: an absent field keeps its default, an unknown field is an Error (a misspelt one
// would be lost otherwise).

#include <fmt/format.h>

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <type_traits>
#include <vector>

#include "core/error.h"
#include "core/geometry/pose.h"
#include "projects/file/stored_text.h"

namespace seamwright {

// What goes into a document.
struct ArchiveOptions {
    bool profiles = true;     // reference and template profiles as number lists
    bool rigid_poses = true;  // poses must be rigid; results of a failed computation need not be
    bool patterns = true;     // sentences as stored_text.h has them, to be read back; without, in English
};

// Words of an enum in the order of its values; specialised beside describe().
template <class E>
struct EnumWords;

class JsonWriter {
  public:
    static constexpr bool reading = false;
    explicit JsonWriter(const ArchiveOptions& options) : options_(options) {}
    const ArchiveOptions& options() const { return options_; }

    template <class T>
    nlohmann::json document(const T& value) {
        return encode(value);
    }
    template <class T>
    void operator()(const char* name, T& value) {
        (*node_)[name] = encode(value);
    }

  private:
    static nlohmann::json encode(double v) {
        if (std::isfinite(v)) return v;
        return std::isnan(v) ? "nan" : v > 0 ? "inf" : "-inf";
    }
    static nlohmann::json encode(float v) { return encode(static_cast<double>(v)); }
    static nlohmann::json encode(bool v) { return v; }
    static nlohmann::json encode(const std::string& v) { return v; }
    nlohmann::json encode(const Text& v) {
        return options_.patterns ? text_json(v) : nlohmann::json(v.english());
    }
    static nlohmann::json encode(const nlohmann::json& v) { return v; }
    static nlohmann::json encode(const Pose& pose);
    nlohmann::json encode(const std::vector<bool>&) = delete;
    template <class T>
    nlohmann::json encode(const std::vector<T>& v) {
        nlohmann::json list = nlohmann::json::array();
        for (const T& item : v) list.push_back(encode(item));
        return list;
    }
    template <class T, std::size_t N>
    nlohmann::json encode(const std::array<T, N>& v) {
        nlohmann::json list = nlohmann::json::array();
        for (const T& item : v) list.push_back(encode(item));
        return list;
    }
    template <class T>
    nlohmann::json encode(const std::optional<T>& v) {
        return v ? encode(*v) : nlohmann::json();
    }
    nlohmann::json encode(const std::map<std::string, double>& v) {
        nlohmann::json object = nlohmann::json::object();
        for (const auto& [key, number] : v) object[key] = encode(number);
        return object;
    }
    template <int R, int C>
    nlohmann::json encode(const Eigen::Matrix<double, R, C>& v) {
        nlohmann::json list = nlohmann::json::array();
        for (int r = 0; r < R; ++r)
            for (int c = 0; c < C; ++c) list.push_back(encode(v(r, c)));
        return list;
    }
    template <class T>
    nlohmann::json encode(const T& v) {
        if constexpr (std::is_enum_v<T>) {
            const auto index = static_cast<std::size_t>(v);
            return index < EnumWords<T>::words.size() ? EnumWords<T>::words[index] : "";
        } else if constexpr (std::is_integral_v<T>) {
            return v;
        } else {
            nlohmann::json object = nlohmann::json::object();
            nlohmann::json* outer = node_;
            node_ = &object;
            describe(*this,
                     const_cast<T&>(v));  // describe() takes the reader's reference; the writer only reads
            node_ = outer;
            return object;
        }
    }

    ArchiveOptions options_;
    nlohmann::json* node_ = nullptr;
};

// Stops at the first thing it cannot read; error() says what and where.
class JsonReader {
  public:
    static constexpr bool reading = true;
    explicit JsonReader(const ArchiveOptions& options) : options_(options) {}
    const ArchiveOptions& options() const { return options_; }

    template <class T>
    Expected<T> document(const nlohmann::json& json, const std::string& where) {
        T value{};
        path_ = where;
        error_.reset();
        decode(json, value);
        if (error_) return tl::unexpected(*error_);
        return value;
    }
    template <class T>
    void operator()(const char* name, T& value) {
        known_->insert(name);
        if (error_) return;
        const auto it = node_->find(name);
        if (it == node_->end()) return;
        At at(*this, path_.empty() ? name : "." + std::string(name));
        decode(*it, value);
    }
    void fail(Text what, Text mend = {}) {
        if (!error_) error_ = Error{ErrorKind::input, std::move(what), path_, std::move(mend)};
    }

  private:
    struct At {  // a step down the path for the life of the object
        At(JsonReader& reader, const std::string& step) : r(reader), length(reader.path_.size()) {
            r.path_ += step;
        }
        ~At() { r.path_.resize(length); }
        At(const At&) = delete;
        At& operator=(const At&) = delete;
        JsonReader& r;
        std::size_t length;
    };
    void expected(const char* what, const nlohmann::json& json) {
        fail(Text("{} was expected, this is {}", what, json.type_name()));
    }
    void decode(const nlohmann::json& json, double& v) {
        if (json.is_number()) {
            v = json.get<double>();
        } else if (json == "nan") {
            v = std::numeric_limits<double>::quiet_NaN();
        } else if (json == "inf" || json == "-inf") {
            v = (json == "inf" ? 1 : -1) * std::numeric_limits<double>::infinity();
        } else {
            expected("a number", json);
        }
    }
    void decode(const nlohmann::json& json, float& v) {
        double d = 0;
        decode(json, d);
        if (std::isfinite(d) && std::abs(d) > std::numeric_limits<float>::max())
            fail("the number is too large");
        else
            v = static_cast<float>(d);
    }
    void decode(const nlohmann::json& json, bool& v) {
        if (json.is_boolean())
            v = json.get<bool>();
        else
            expected("true or false", json);
    }
    void decode(const nlohmann::json& json, std::string& v) {
        if (json.is_string())
            v = json.get<std::string>();
        else
            expected("a text", json);
    }
    void decode(const nlohmann::json& json, nlohmann::json& v) { v = json; }
    void decode(const nlohmann::json& json, Pose& pose);
    bool list(const nlohmann::json& json, std::size_t size) {
        if (!json.is_array())
            expected("a list", json);
        else if (size && json.size() != size)
            fail(Text("{} entries were expected, there are {}", size, json.size()));
        return !error_;
    }
    template <class T>
    void decode(const nlohmann::json& json, std::vector<T>& v) {
        if (!list(json, 0)) return;
        v.clear();
        v.resize(json.size());
        for (std::size_t i = 0; i < json.size() && !error_; ++i) {
            At at(*this, "[" + std::to_string(i) + "]");
            decode(json[i], v[i]);
        }
    }
    void decode(const nlohmann::json& json, Text& v) {
        auto text = text_from_json(json);
        if (!text) return fail(text.error().what);
        v = *std::move(text);
    }
    template <class T, std::size_t N>
    void decode(const nlohmann::json& json, std::array<T, N>& v) {
        if (!list(json, N)) return;
        for (std::size_t i = 0; i < N && !error_; ++i) {
            At at(*this, "[" + std::to_string(i) + "]");
            decode(json[i], v[i]);
        }
    }
    template <class T>
    void decode(const nlohmann::json& json, std::optional<T>& v) {
        if (json.is_null())
            v.reset();
        else
            decode(json, v.emplace());
    }
    void decode(const nlohmann::json& json, std::map<std::string, double>& v) {
        if (!json.is_object()) return expected("an object", json);
        v.clear();
        for (const auto& item : json.items()) {
            At at(*this, "." + item.key());
            decode(item.value(), v[item.key()]);
        }
    }
    template <int R, int C>
    void decode(const nlohmann::json& json, Eigen::Matrix<double, R, C>& v) {
        if (!list(json, static_cast<std::size_t>(R * C))) return;
        for (int i = 0; i < R * C && !error_; ++i) {
            At at(*this, "[" + std::to_string(i) + "]");
            decode(json[static_cast<std::size_t>(i)], v(i / C, i % C));
        }
    }
    template <class T>
    void decode(const nlohmann::json& json, T& v) {
        if constexpr (std::is_enum_v<T>) {
            const auto& words = EnumWords<T>::words;
            for (std::size_t i = 0; i < words.size(); ++i)
                if (json == words[i]) {
                    v = static_cast<T>(i);
                    return;
                }
            std::string known;
            for (const char* word : words) known += (known.empty() ? "" : ", ") + std::string(word);
            fail("the word is not known here", Text("known are: {}", known));
        } else if constexpr (std::is_integral_v<T>) {
            const bool fits = json.is_number_unsigned()
                                  ? std::in_range<T>(json.get<std::uint64_t>())
                                  : json.is_number_integer() && std::in_range<T>(json.get<std::int64_t>());
            if (fits)
                v = static_cast<T>(json.get<std::int64_t>());
            else if (json.is_number_integer())
                fail("the number is out of range");
            else
                expected("a whole number", json);
        } else {
            if (!json.is_object()) return expected("an object", json);
            const nlohmann::json* outer = node_;
            std::set<std::string>* outer_known = known_;
            std::set<std::string> known;
            node_ = &json;
            known_ = &known;
            describe(*this, v);
            node_ = outer;
            known_ = outer_known;
            if (error_) return;
            for (const auto& item : json.items())
                if (!known.count(item.key())) {
                    At at(*this, path_.empty() ? item.key() : "." + item.key());
                    return fail("unknown field");
                }
        }
    }

    ArchiveOptions options_;
    const nlohmann::json* node_ = nullptr;
    std::set<std::string>* known_ = nullptr;
    std::string path_;
    std::optional<Error> error_;
};

}  // namespace seamwright
