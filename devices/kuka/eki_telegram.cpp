#include "devices/kuka/eki_telegram.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <pugixml.hpp>
#include <utility>

#include "core/geometry/notation.h"
#include "core/number_text.h"

namespace seamwright {
namespace {

constexpr const char* kEkiNothing = "-";
constexpr const char* kEkiWhere = "EthernetKRL telegram";
constexpr std::array<const char*, 6> kPos = {"X", "Y", "Z", "A", "B", "C"};
constexpr std::array kEkiModes = {
    std::pair{RobotMode::manual_reduced, "#T1"}, std::pair{RobotMode::manual_full, "#T2"},
    std::pair{RobotMode::automatic, "#AUT"},     std::pair{RobotMode::external, "#EX"},
    std::pair{RobotMode::stopped, "#STOP"},      std::pair{RobotMode::fault, "#FAULT"}};

Expected<EkiTelegram> parse(std::string_view document, std::string_view root_name) {
    pugi::xml_document xml;
    const auto parsed =
        xml.load_buffer(document.data(), document.size(), pugi::parse_default, pugi::encoding_utf8);
    if (!parsed) return device_error(Text("is no XML: {}", parsed.description()), kEkiWhere);
    const pugi::xml_node root = xml.document_element();
    if (std::string_view(root.name()) != root_name)
        return device_error(Text("the root is not {}", root_name), kEkiWhere,
                            "load Seamwright.xml of this version on the controller");
    EkiTelegram t;
    const auto text = [&](const char* name, std::string& value) {
        const auto attribute = root.attribute(name);
        value = attribute.value();
        if (value == kEkiNothing) value.clear();
        return attribute && value.size() <= kEkiLongestTelegram;
    };
    if (!text("Kind", t.kind) || t.kind.empty() || !text("Name", t.name) || !text("Text", t.text))
        return device_error("lacks Kind, Name or Text", kEkiWhere,
                            "load Seamwright.xml of this version on the controller");
    text("Part", t.part);
    text("Mode", t.mode);
    const auto id = root.attribute("Id");
    t.id = id.as_llong(-1);
    if (!id || t.id < 0 || std::to_string(t.id) != id.value())
        return device_error("has no number Id", kEkiWhere);
    const pugi::xml_node pos = root.child("Pos");
    std::array<double, 6> v{};
    for (std::size_t i = 0; i < 6; ++i) {
        const auto attribute = pos.attribute(kPos[i]);
        const std::string value = attribute.value();
        const bool sign = value.size() > 1 && value[0] == '+' && value[1] != '-';
        const auto number = number_from<double>(std::string_view(value).substr(sign ? 1 : 0));
        if (!number) return device_error(Text("has no number Pos/{}", kPos[i]), kEkiWhere);
        v[i] = *number;
        if (!(std::abs(v[i]) <= (i < 3 ? 1e5 : 360.0)))
            return device_error(Text("Pos/{} = {} is no position of a robot", kPos[i], value), kEkiWhere);
    }
    t.pose = make_pose(rotation_from_kuka({v[3], v[4], v[5]}), {v[0], v[1], v[2]});
    return t;
}

}  // namespace

Expected<EkiTelegram> parse_eki_telegram(std::string_view document) {
    return parse(document, "Robot");
}

Expected<EkiTelegram> parse_eki_command(std::string_view document) {
    return parse(document, "Sensor");
}

std::string write_eki(std::string_view root, const EkiTelegram& t) {
    pugi::xml_document xml;
    pugi::xml_node node = xml.append_child(std::string(root).c_str());
    const auto text = [&](const char* name, const std::string& value) {
        // KRL has no empty string.
        node.append_attribute(name) = value.empty() ? kEkiNothing : value.substr(0, kEkiLongestText).c_str();
    };
    text("Kind", t.kind);
    node.append_attribute("Id") = static_cast<long long>(t.id);
    text("Name", t.name);
    text("Part", t.part);
    text("Mode", t.mode);
    text("Text", t.text);
    const KukaAbc abc = kuka_from_rotation(t.pose.linear());
    const Eigen::Vector3d& p = t.pose.translation();
    const std::array<double, 6> v = {p.x(), p.y(), p.z(), abc.a_deg, abc.b_deg, abc.c_deg};
    pugi::xml_node pos = node.append_child("Pos");
    for (std::size_t i = 0; i < 6; ++i) pos.append_attribute(kPos[i]) = fmt::format("{:.6f}", v[i]).c_str();
    struct Writer final : pugi::xml_writer {
        std::string out;
        void write(const void* data, std::size_t size) override {
            out.append(static_cast<const char*>(data), size);
        }
    } writer;
    node.print(writer, "", pugi::format_raw);
    return writer.out;
}

Expected<void> EkiSplitter::add(std::string_view bytes) {
    for (const char c : bytes)
        if (c != '\0') buffer_ += c;
    for (std::size_t from = 0, at; (at = buffer_.find(end_, from)) != std::string::npos;) {
        // XML allows blanks before the '>'; another sign there makes it another element's name.
        const std::size_t end = buffer_.find_first_not_of(" \t\r\n", at + end_.size());
        if (end == std::string::npos || end >= kEkiLongestTelegram) break;
        from = at + 1;
        if (buffer_[end] != '>') continue;
        documents_.push_back(buffer_.substr(0, end + 1));
        buffer_.erase(0, end + 1);
        from = 0;
    }
    if (buffer_.size() > kEkiLongestTelegram)
        return device_error(Text("is longer than {} bytes", kEkiLongestTelegram), kEkiWhere,
                            "check that Seamwright's module talks on this port");
    return {};
}

bool EkiSplitter::next(std::string& document) {
    if (documents_.empty()) return false;
    document = std::move(documents_.front());
    documents_.pop_front();
    return true;
}

bool EkiSplitter::in_the_middle() const {
    return buffer_.find_first_not_of(" \t\r\n") != std::string::npos;
}

void EkiSplitter::clear() {
    buffer_.clear();
    documents_.clear();
}

Expected<RobotMode> mode_from_eki(std::string_view mode) {
    for (const auto& [known, name] : kEkiModes)
        if (mode == name) return known;
    return device_error(Text("\"{}\" is no operating mode", mode.substr(0, 20)), kEkiWhere);
}

}  // namespace seamwright
