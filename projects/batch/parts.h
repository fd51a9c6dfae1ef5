#pragma once
// A computation that is made of loops whose values depend on their index alone, split between processes.
//
// Each process goes the whole way and computes every n-th value of every loop; the values that it leaves stand in its part, and what
// it makes of the others is of no use. Who collects the parts goes the same way once more and takes all values from them, so what
// becomes of them is computed in the same order from the same bits as in one process. Loops are told apart by their order, which
// must not depend on the values.

#include <bit>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"

namespace seamwright {

// Part `number` of `of`, from 0 on.
struct Portion {
    int number = 0, of = 1;
    bool holds(std::size_t index) const {
        return static_cast<int>(index % static_cast<std::size_t>(of)) == number;
    }
};
// "3/8". Error (usage): another form, a part that there is not.
Expected<Portion> portion_from(const std::string& text, const std::string& option);
std::string to_string(const Portion& portion);

// The numbers of one value of a loop, to the bit: into the part, or out of it in the same order.
class PartValue {
  public:
    explicit PartValue(std::vector<std::uint64_t>* into) : into_(into) {}
    explicit PartValue(const std::vector<std::uint64_t>* from) : from_(from) {}
    void operator()(double& v) {
        if (into_)
            into_->push_back(std::bit_cast<std::uint64_t>(v));
        else
            v = std::bit_cast<double>(next());
    }
    void operator()(bool& v) {
        if (into_)
            into_->push_back(v ? 1 : 0);
        else
            v = next() != 0;
    }
    // Of any fixed-size matrix.
    template <class Matrix>
    void matrix(Matrix& m) {
        for (auto& v : m.reshaped()) (*this)(v);
    }
    template <class T, class Each>
    void list(std::vector<T>& values, const Each& each) {
        if (into_)
            into_->push_back(values.size());
        else
            values.resize(size());
        for (T& v : values) each(v);
    }
    template <class T, class Each>
    void maybe(std::optional<T>& value, const Each& each) {
        bool there = value.has_value();
        (*this)(there);
        if (there && !value) value.emplace();
        if (there) each(*value);
    }
    // Everything was read, and nothing was missing.
    bool sound() const { return !missing_ && (!from_ || at_ == from_->size()); }

  private:
    std::uint64_t next() {
        if (at_ < from_->size()) return (*from_)[at_++];
        missing_ = true;
        return 0;
    }
    std::size_t size() {
        const std::uint64_t n = next();
        if (n <= from_->size()) return static_cast<std::size_t>(n);
        missing_ = true;
        return 0;
    }
    std::vector<std::uint64_t>* into_ = nullptr;
    const std::vector<std::uint64_t>* from_ = nullptr;
    std::size_t at_ = 0;
    bool missing_ = false;
};

class Parts {
  public:
    explicit Parts(Portion portion) : portion_(portion) {}
    // Error (file): a part that is none, that is there twice or not at all.
    static Expected<Parts> collected(std::span<const nlohmann::json> parts);
    nlohmann::json json() const;  // of the part

    // The next loop, of so many values: those that are to be computed here.
    std::vector<std::size_t> begin(std::size_t count);
    // After they are computed. `each(value, i)` hands over the numbers of value i; `counted` is what was counted meanwhile, and what
    // all parts counted is returned.
    template <class Each>
    std::size_t end(const Each& each, std::size_t counted) {
        Loop& loop = loops_[next_++];
        if (!collects_) {
            loop.counted = counted;
            for (std::size_t i = 0; i < loop.values.size(); ++i) {
                if (!portion_.holds(i)) continue;
                PartValue value(&loop.values[i]);
                each(value, i);
            }
            return counted;
        }
        for (std::size_t i = 0; i < loop.values.size(); ++i) {
            PartValue value(&std::as_const(loop.values)[i]);
            each(value, i);
            sound_ = sound_ && value.sound();
        }
        return counted + loop.counted;
    }
    // Of collected parts, at the end: whether they were those of this computation. Error (file).
    Expected<void> check() const;

  private:
    struct Loop {
        std::size_t counted = 0;
        std::vector<std::vector<std::uint64_t>> values;
    };
    Portion portion_;
    bool collects_ = false, sound_ = true;
    std::vector<Loop> loops_;
    std::size_t next_ = 0;
};

}  // namespace seamwright
