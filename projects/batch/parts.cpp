#include "projects/batch/parts.h"

#include <charconv>

namespace seamwright {
namespace {

using nlohmann::json;

Error no_part() {
    return Error{
        ErrorKind::file, "a part is damaged, or of another computation", {}, "delete it: it is made again"};
}

}  // namespace

Expected<Portion> portion_from(const std::string& text, const std::string& option) {
    Portion p;
    const char* const end = text.data() + text.size();
    const auto number = std::from_chars(text.data(), end, p.number);
    if (number.ec == std::errc() && number.ptr != end && *number.ptr == '/') {
        const auto of = std::from_chars(number.ptr + 1, end, p.of);
        if (of.ec == std::errc() && of.ptr == end && p.number >= 0 && p.of >= 1 && p.number < p.of) return p;
    }
    return usage_error(Text("\"{}\" is no part", text), option, "write 0/8 for the first of eight");
}

std::string to_string(const Portion& portion) {
    return std::to_string(portion.number) + "/" + std::to_string(portion.of);
}

std::vector<std::size_t> Parts::begin(std::size_t count) {
    if (collects_ && (next_ >= loops_.size() || loops_[next_].values.size() != count)) {
        sound_ = false;  // the values stay as they are
        loops_.resize(std::max(loops_.size(), next_ + 1));
        loops_[next_] = {0, std::vector<std::vector<std::uint64_t>>(count)};
    }
    std::vector<std::size_t> mine;
    if (collects_) return mine;
    loops_.push_back({0, std::vector<std::vector<std::uint64_t>>(count)});
    for (std::size_t i = 0; i < count; ++i)
        if (portion_.holds(i)) mine.push_back(i);
    return mine;
}

json Parts::json() const {
    nlohmann::json loops = nlohmann::json::array();
    for (const Loop& loop : loops_) {
        nlohmann::json values = nlohmann::json::array();
        for (std::size_t i = 0; i < loop.values.size(); ++i)
            if (portion_.holds(i)) values.push_back(loop.values[i]);
        loops.push_back(
            {{"of", loop.values.size()}, {"counted", loop.counted}, {"values", std::move(values)}});
    }
    return {{"part", portion_.number}, {"of", portion_.of}, {"loops", std::move(loops)}};
}

Expected<Parts> Parts::collected(std::span<const nlohmann::json> parts) {
    Parts out{Portion{}};
    out.collects_ = true;
    try {
        for (std::size_t k = 0; k < parts.size(); ++k) {
            const nlohmann::json& part = parts[k];
            const Portion portion{static_cast<int>(k), static_cast<int>(parts.size())};
            const nlohmann::json& loops = part.at("loops");
            if (part.at("part") != portion.number || part.at("of") != portion.of)
                return tl::unexpected(no_part());
            if (k == 0) out.loops_.resize(loops.size());
            if (loops.size() != out.loops_.size()) return tl::unexpected(no_part());
            for (std::size_t l = 0; l < loops.size(); ++l) {
                Loop& loop = out.loops_[l];
                const auto count = loops[l].at("of").get<std::size_t>();
                const nlohmann::json& values = loops[l].at("values");
                // As many as belong to this part, which also bounds what is set aside for them.
                const std::size_t mine = count > k ? (count - k - 1) / parts.size() + 1 : 0;
                if (values.size() != mine || (k > 0 && loop.values.size() != count))
                    return tl::unexpected(no_part());
                loop.values.resize(count);
                loop.counted += loops[l].at("counted").get<std::size_t>();
                for (std::size_t i = 0; i < mine; ++i)
                    loop.values[k + i * parts.size()] = values[i].get<std::vector<std::uint64_t>>();
            }
        }
    } catch (const nlohmann::json::exception&) {
        return tl::unexpected(no_part());
    }
    return out;
}

Expected<void> Parts::check() const {
    if (collects_ && (!sound_ || next_ != loops_.size())) return tl::unexpected(no_part());
    return {};
}

}  // namespace seamwright
