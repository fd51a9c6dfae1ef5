#include "devices/controllers/kuka/eki_channel.h"

#include <arpa/inet.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <pugixml.hpp>
#include <set>

#include "core/number_text.h"

namespace seamwright::krl {
namespace {

constexpr std::size_t kLongestString = 3600;
constexpr Timeout kEkiConnect{500}, kEkiTick{2}, kEkiSend{500};
constexpr std::size_t kLongestDocument = 16384;

// Reads the attributes and children of a node and refuses what it was not asked for.
class Strict {
  public:
    explicit Strict(const pugi::xml_node& node) : node_(node) {}
    std::optional<std::string> attribute(const char* name) {
        known_.insert(name);
        const auto a = node_.attribute(name);
        return a ? std::optional<std::string>(a.value()) : std::nullopt;
    }
    std::optional<int> number(const char* name, int low, int high) {
        const auto text = attribute(name);
        if (!text) return std::nullopt;
        const auto value = number_from<int>(*text);
        if (!value || *value < low || *value > high)
            throw KrlError(fmt::format("{} {}=\"{}\" is not {} to {}", node_.name(), name, *text, low, high));
        return value;
    }
    void done(const std::set<std::string>& children) const {
        for (const auto a : node_.attributes())
            if (known_.count(a.name()) == 0)
                throw KrlError(fmt::format("EthernetKRL does not know {} {}", node_.name(), a.name()));
        std::set<std::string> seen;
        for (const auto child : node_.children()) {
            if (child.type() != pugi::node_element) {
                if (child.type() == pugi::node_pcdata)
                    throw KrlError(fmt::format("text stands in {}", node_.name()));
                continue;
            }
            const std::string name = child.name();
            if (children.count(name) == 0)
                throw KrlError(fmt::format("EthernetKRL does not know {} in {}", name, node_.name()));
            if (name != "ELEMENT" && !seen.insert(name).second)
                throw KrlError(fmt::format("{} stands twice in {}", name, node_.name()));
        }
    }

  private:
    pugi::xml_node node_;
    std::set<std::string> known_;
};

pugi::xml_node needed(const pugi::xml_node& node, const char* name) {
    const auto child = node.child(name);
    if (!child) throw KrlError(fmt::format("{} lacks {}", node.name(), name));
    return child;
}

void check_tag(const std::string& tag, std::set<std::string>& seen) {
    if (tag.empty() || tag.find_first_of(" <>\"'&") != std::string::npos || tag.front() == '/' ||
        tag.back() == '/')
        throw KrlError(fmt::format("\"{}\" is no tag", tag));
    const auto at = tag.find('@');
    if (at != std::string::npos && (at == 0 || tag[at - 1] != '/' || tag.find('/', at) != std::string::npos))
        throw KrlError(fmt::format("\"{}\": an attribute stands last, behind /", tag));
    if (!seen.insert(tag).second) throw KrlError(fmt::format("the tag {} stands twice", tag));
}

std::vector<EkiElement> elements_of(const pugi::xml_node& list, bool receive) {
    Strict(list).done({"XML"});
    const auto xml = list.child("XML");
    if (!xml) throw KrlError(fmt::format("{} lacks XML", list.name()));
    Strict(xml).done({"ELEMENT"});
    std::vector<EkiElement> all;
    std::set<std::string> seen;
    static const std::set<std::string> types = {"STRING", "REAL", "INT", "BOOL", "FRAME"};
    for (const auto node : xml.children("ELEMENT")) {
        Strict element(node);
        EkiElement e;
        e.tag = element.attribute("Tag").value_or("");
        check_tag(e.tag, seen);
        if (receive) {
            e.type = element.attribute("Type").value_or("");
            e.flag = element.number("Set_Flag", 1, 1024).value_or(0);
            if (!e.type.empty() && types.count(e.type) == 0)
                throw KrlError(fmt::format("{} is no type", e.type));
            if (e.type.empty() && e.flag == 0)
                throw KrlError(fmt::format("{} has neither Type nor Set_Flag", e.tag));
        }
        element.done({});
        all.push_back(std::move(e));
    }
    return all;
}

// Text of an element or an attribute at "Root/A/@b" in the document.
std::optional<std::string> at_path(const pugi::xml_document& document, const std::string& tag) {
    pugi::xml_node node = document;
    std::string_view rest = tag;
    while (!rest.empty()) {
        const auto end = std::min(rest.find('/'), rest.size());
        const std::string step(rest.substr(0, end));
        rest.remove_prefix(std::min(end + 1, rest.size()));
        if (step.starts_with('@')) {
            const auto attribute = node.attribute(step.c_str() + 1);
            return attribute ? std::optional<std::string>(attribute.value()) : std::nullopt;
        }
        node = node.child(step.c_str());
        if (!node) return std::nullopt;
    }
    return node.text().get();
}

std::string text_of(const pugi::xml_document& document) {
    struct Writer final : pugi::xml_writer {
        std::string out;
        void write(const void* data, std::size_t size) override {
            out.append(static_cast<const char*>(data), size);
        }
    } writer;
    document.document_element().print(writer, "", pugi::format_raw);
    return writer.out + "\r\n";
}

}  // namespace

EkiConfiguration parse_eki_configuration(const std::string& xml) {
    pugi::xml_document document;
    const auto parsed = document.load_buffer(xml.data(), xml.size());
    if (!parsed) throw KrlError(fmt::format("is no XML: {}", parsed.description()));
    const auto root = document.document_element();
    if (std::string_view(root.name()) != "ETHERNETKRL") throw KrlError("the root is not ETHERNETKRL");
    Strict(root).done({"CONFIGURATION", "RECEIVE", "SEND"});
    const auto configuration = needed(root, "CONFIGURATION");
    Strict(configuration).done({"EXTERNAL", "INTERNAL"});
    const auto external = needed(configuration, "EXTERNAL");
    Strict(external).done({"TYPE", "IP", "PORT"});
    if (std::string_view(needed(external, "TYPE").text().get()) != "Server")
        throw KrlError("EXTERNAL TYPE is not Server: the controller is the client");
    EkiConfiguration c;
    c.address = needed(external, "IP").text().get();
    in_addr address{};
    if (::inet_pton(AF_INET, c.address.c_str(), &address) != 1 || address.s_addr == 0)
        throw KrlError(fmt::format("IP {} is no address to connect to", c.address));
    const auto port = number_from<int>(needed(external, "PORT").text().get());
    if (!port || *port < 1 || *port > 65534) throw KrlError("PORT is not 1 to 65534");
    c.port = static_cast<std::uint16_t>(*port);
    if (const auto internal = configuration.child("INTERNAL")) {
        Strict(internal).done(
            {"ENVIRONMENT", "BUFFERING", "BUFFSIZE", "TIMEOUT", "ALIVE", "MESSAGES", "PROTOCOL"});
        if (const auto node = internal.child("ENVIRONMENT")) {
            const std::string_view where = node.text().get();
            if (where != "Program" && where != "Submit" && where != "System")
                throw KrlError("ENVIRONMENT is none of Program, Submit, System");
        }
        if (const auto node = internal.child("BUFFERING")) {
            Strict s(node);
            const auto mode = s.attribute("Mode");
            if (mode && *mode != "FIFO" && *mode != "LIFO")
                throw KrlError("BUFFERING Mode is neither FIFO nor LIFO");
            c.fifo = static_cast<std::size_t>(s.number("Limit", 1, 512).value_or(16));
            s.done({});
        }
        if (const auto node = internal.child("BUFFSIZE")) {
            Strict s(node);
            c.buffer = static_cast<std::size_t>(s.number("Limit", 1, 65534).value_or(16384));
            s.done({});
        }
        if (const auto node = internal.child("TIMEOUT")) {
            Strict s(node);
            (void)s.number("Connect", 0, 65534);
            s.done({});
        }
        if (const auto node = internal.child("ALIVE")) {
            Strict s(node);
            c.alive_flag = s.number("Set_Flag", 1, 1024).value_or(0);
            (void)s.number("Set_Out", 1, 4096);
            (void)s.number("Ping", 1, 65534);
            s.done({});
        }
        if (const auto node = internal.child("MESSAGES")) {
            Strict s(node);
            const auto display = s.attribute("Display"), logging = s.attribute("Logging");
            if (display && *display != "error" && *display != "disabled")
                throw KrlError("MESSAGES Display is neither error nor disabled");
            if (logging && *logging != "error" && *logging != "warning" && *logging != "disabled")
                throw KrlError("MESSAGES Logging is none of error, warning, disabled");
            s.done({});
        }
    }
    c.receive = elements_of(needed(root, "RECEIVE"), true);
    c.send = elements_of(needed(root, "SEND"), false);
    return c;
}

EkiChannel::EkiChannel(EkiConfiguration configuration, SetFlag set_flag,
                       std::function<ControllerFault()> fault, Timeout slow,
                       std::function<void()> before_telegram)
    : configuration_(std::move(configuration)),
      set_flag_(std::move(set_flag)),
      fault_(std::move(fault)),
      slow_(slow),
      before_telegram_(std::move(before_telegram)) {}

EkiChannel::~EkiChannel() {
    (void)close();
}

EkiChannel::Status EkiChannel::open() {
    (void)close();
    auto made = TcpConnection::connect(configuration_.address, configuration_.port, kEkiConnect);
    if (!made) return {9, false, 0, 0};
    {
        const std::lock_guard lock(mutex_);
        connection_ = std::make_shared<TcpConnection>(std::move(*made));
        connected_ = true;
        fifos_.clear();
    }
    if (configuration_.alive_flag > 0) set_flag_(configuration_.alive_flag, true);
    reader_ = std::jthread([this](const std::stop_token& stop) { receive(stop); });
    return {0, true, 0, 0};
}

EkiChannel::Status EkiChannel::close() {
    reader_ = {};  // it ends within its tick
    {
        const std::lock_guard lock(mutex_);
        connection_.reset();
        connected_ = false;
        fifos_.clear();
        values_.clear();
    }
    if (configuration_.alive_flag > 0) set_flag_(configuration_.alive_flag, false);
    return {};
}

void EkiChannel::receive(const std::stop_token& stop) {
    std::string root = configuration_.receive.empty() ? "" : configuration_.receive.front().tag;
    const std::string end = "</" + root.substr(0, root.find('/')) + ">";
    std::string stream;
    bool good = true;
    while (good && !stop.stop_requested()) {
        std::array<char, 4096> buffer;
        Expected<std::size_t> got = 0;
        {
            const std::lock_guard lock(connection_mutex_);
            got = connection_->receive_some(std::as_writable_bytes(std::span(buffer)), kEkiTick);
        }
        if (!got && is_silence(got.error())) {
            std::this_thread::sleep_for(std::chrono::milliseconds(1));  // let a send have the connection
            continue;
        }
        good = got.has_value();
        if (!good) break;
        stream.append(buffer.data(), *got);
        for (std::size_t at; good && (at = stream.find(end)) != std::string::npos;) {
            const std::string document = stream.substr(0, at + end.size());
            stream.erase(0, at + end.size());
            good = document.size() <= kLongestDocument && arrived(document);
        }
        good = good && stream.size() <= kLongestDocument;
    }
    if (stop.stop_requested()) return;
    {
        const std::lock_guard lock(mutex_);
        connected_ = false;
    }
    if (configuration_.alive_flag > 0) set_flag_(configuration_.alive_flag, false);
}

bool EkiChannel::arrived(const std::string& text) {
    pugi::xml_document document;
    if (!document.load_buffer(text.data(), text.size())) return false;
    if (fault_() == ControllerFault::reject_write && reject(text)) return true;
    before_telegram_();
    std::vector<int> flags;
    {
        const std::lock_guard lock(mutex_);
        for (const EkiElement& e : configuration_.receive) {
            const auto value = at_path(document, e.tag);
            if (!value) continue;
            if (!e.type.empty()) {
                auto& fifo = fifos_[e.tag];
                // "The maximum number of data elements is stored": nothing more is received.
                if (fifo.size() >= configuration_.fifo) return false;
                const bool good = e.type == "STRING" ? value->size() <= kLongestString
                                  : e.type == "INT"  ? number_from<std::int32_t>(*value).has_value()
                                  : e.type == "REAL" ? number_from<double>(*value).has_value()
                                                     : true;
                if (!good) return false;
                fifo.push_back(*value);
            }
            if (e.flag > 0) flags.push_back(e.flag);
        }
    }
    for (const int flag : flags) set_flag_(flag, true);
    return true;
}

// The controller is set so that nothing may be written: the answer that the module would give.
bool EkiChannel::reject(const std::string& text) {
    pugi::xml_document document;
    document.load_buffer(text.data(), text.size());
    const auto command = document.document_element();
    static const std::set<std::string> writing = {"write", "confirm", "measure", "move"};
    if (writing.count(command.attribute("Kind").value()) == 0) return false;
    put(fmt::format(
        "<Robot Kind=\"error\" Id=\"{}\" Name=\"{}\" Part=\"-\" Mode=\"#EX\" Text=\"write protected\">"
        "<Pos X=\"0\" Y=\"0\" Z=\"0\" A=\"0\" B=\"0\" C=\"0\"/></Robot>\r\n",
        command.attribute("Id").value(), command.attribute("Name").value()));
    return true;
}

EkiChannel::Status EkiChannel::check(const std::string& tag) const {
    const std::lock_guard lock(mutex_);
    const auto known = std::find_if(configuration_.receive.begin(), configuration_.receive.end(),
                                    [&](const EkiElement& e) { return e.tag == tag && !e.type.empty(); });
    if (known == configuration_.receive.end())
        throw KrlError(fmt::format("{} is not in the channel's RECEIVE", tag));
    const auto it = fifos_.find(tag);
    return {0, connected_, it == fifos_.end() ? 0 : it->second.size(), 0};
}

EkiChannel::Status EkiChannel::take(const std::string& tag, const std::string& type, std::string& value) {
    (void)check(tag);
    const std::lock_guard lock(mutex_);
    for (const EkiElement& e : configuration_.receive)
        if (e.tag == tag && e.type != type)
            throw KrlError(fmt::format("{} is a {}, not a {}", tag, e.type, type));
    auto& fifo = fifos_[tag];
    if (fifo.empty()) return {10, connected_, 0, 0};
    value = std::move(fifo.front());
    fifo.pop_front();
    return {0, connected_, fifo.size(), 1};
}

void EkiChannel::set(const std::string& tag, std::string value) {
    if (std::none_of(configuration_.send.begin(), configuration_.send.end(),
                     [&](const EkiElement& e) { return e.tag == tag; }))
        throw KrlError(fmt::format("{} is not in the channel's SEND", tag));
    if (value.size() > kLongestString) throw KrlError("a string of over 3600 characters");
    const std::lock_guard lock(mutex_);
    values_[tag] = std::move(value);
}

EkiChannel::Status EkiChannel::send(const std::string& root) {
    pugi::xml_document document;
    bool connected = false;
    {
        const std::lock_guard lock(mutex_);
        for (const EkiElement& e : configuration_.send) {
            if (e.tag != root && !e.tag.starts_with(root + "/")) continue;
            const auto value = values_.find(e.tag);
            if (value == values_.end()) throw KrlError(fmt::format("{} was not set before EKI_Send", e.tag));
            pugi::xml_node node = document;
            std::string_view rest = e.tag;
            while (!rest.empty()) {
                const auto end = std::min(rest.find('/'), rest.size());
                const std::string step(rest.substr(0, end));
                rest.remove_prefix(std::min(end + 1, rest.size()));
                if (step.starts_with('@')) {
                    node.append_attribute(step.c_str() + 1) = value->second.c_str();
                } else {
                    const auto child = node.child(step.c_str());
                    node = child ? child : node.append_child(step.c_str());
                    if (rest.empty()) node.text().set(value->second.c_str());
                }
            }
        }
        values_.clear();
        connected = connected_;
    }
    if (!document.document_element()) throw KrlError(fmt::format("there is nothing to send under {}", root));
    if (!connected) return {9, false, 0, 0};
    auto told = document.document_element();
    const ControllerFault now = fault_();
    if (now == ControllerFault::wrong_answer) {
        const bool hello = std::string_view(told.attribute("Kind").value()) == "hello";
        told.attribute("Id") = told.attribute("Id").as_llong() + 7;
        told.attribute("Name") = hello ? "" : "another";
    }
    if (now == ControllerFault::out_of_range) told.child("Pos").attribute("X") = "1e+09";
    return {put(text_of(document)) ? 0 : 9, true, 0, 0};
}

bool EkiChannel::put(std::string bytes) {
    const ControllerFault now = fault_();
    if (now == ControllerFault::silent) return true;
    if (now == ControllerFault::slow) std::this_thread::sleep_for(slow_);
    const bool cut = now == ControllerFault::half_message || now == ControllerFault::disconnect;
    if (cut) bytes.resize(bytes.size() / 2);
    std::shared_ptr<TcpConnection> connection;
    {
        const std::lock_guard lock(mutex_);
        connection = connection_;
    }
    if (!connection) return false;
    const std::lock_guard lock(connection_mutex_);
    const auto sent = connection->send(bytes_of(bytes), kEkiSend);
    if (now == ControllerFault::disconnect) connection->close();
    return sent && now != ControllerFault::disconnect;
}

}  // namespace seamwright::krl
