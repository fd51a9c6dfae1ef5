#include "devices/line/mqtt.h"

#include <mosquitto.h>

#include <atomic>
#include <cstdlib>
#include <deque>
#include <mutex>
#include <set>
#include <thread>

#include "core/system_text.h"
#include "devices/backoff.h"
#include "devices/exchange/files.h"
#include "devices/host_time.h"
#include "devices/line/modbus_station.h"

namespace seamwright {
namespace {

using nlohmann::json;
using Clock = std::chrono::steady_clock;

struct MqttSettings {
    std::string address, group, node, client_id, username, password;
    std::string ca_file, certificate_file, key_file;
    bool tls = false, line_starts = false;
    int port = 0, keepalive_s = 0;
    std::size_t queue = 0;
    std::chrono::milliseconds timeout{}, call_timeout{}, reconnect{}, reconnect_most{};
};

// From where the settings say it is; it never stands in the project.
Expected<std::string> read_password(const std::string& variable, const std::string& file) {
    if (!variable.empty() && !file.empty())
        return input_error("password_env and password_file are both given", "settings", "keep one");
    if (!variable.empty()) {
        const char* value = std::getenv(variable.c_str());
        if (!value || !*value)
            return input_error(Text("the environment variable {} is not set", variable),
                               "settings.password_env",
                               "set it to the broker's password, or name a file in \"password_file\"");
        return std::string(value);
    }
    if (file.empty()) return std::string();
    SEAM_TRY(auto text, read_text_file(file));
    std::string password = text.substr(0, text.find('\n'));
    if (!password.empty() && password.back() == '\r') password.pop_back();
    if (password.empty())
        return input_error("the first line of the file is empty", file,
                           "write the broker's password into it");
    return password;
}

Expected<MqttSettings> read_settings(const json& settings, const std::string& name) {
    MqttSettings s;
    std::string variable, file, start;
    SettingsReader r(settings, "settings", mqtt_settings());
    r.text("address", s.address);
    r.whole("port", s.port);
    r.text("group", s.group);
    r.text("node", s.node);
    r.text("client_id", s.client_id);
    r.text("username", s.username);
    r.text("password_env", variable);
    r.text("password_file", file);
    r.truth("tls", s.tls);
    r.text("ca_file", s.ca_file);
    r.text("certificate_file", s.certificate_file);
    r.text("key_file", s.key_file);
    r.whole("keepalive_s", s.keepalive_s);
    r.duration("timeout_ms", s.timeout);
    r.whole("queue", s.queue);
    r.text("start", start);
    r.duration("call_timeout_ms", s.call_timeout);
    r.duration("reconnect_ms", s.reconnect);
    r.duration("reconnect_most_ms", s.reconnect_most);
    if (r.failed()) return tl::unexpected(r.error());
    s.line_starts = start == "line";
    if (s.node.empty()) s.node = name;
    if (s.client_id.empty()) s.client_id = "seamwright-" + topic_level(s.group) + "-" + topic_level(s.node);
    SEAM_TRY(s.password, read_password(variable, file));
    if (s.username.empty() && !s.password.empty())
        return input_error("a password without a user's name", "settings.username");
    if (!s.tls && !(s.ca_file + s.certificate_file + s.key_file).empty())
        return input_error("certificates are named, and TLS is off", "settings.tls", "write \"tls\": true");
    if (s.tls && s.ca_file.empty())
        return input_error("the certificate that the broker's is checked with is missing", "settings.ca_file",
                           "name a PEM file");
    if (s.certificate_file.empty() != s.key_file.empty())
        return input_error("certificate_file and key_file belong together", "settings");
    return s;
}

class Mqtt : public LineLink {
  public:
    explicit Mqtt(MqttSettings settings)
        : settings_(std::move(settings)), backoff_(settings_.reconnect, settings_.reconnect_most) {
        state_topic_ = mqtt_topic(settings_.group, "STATE", settings_.node);
        result_topic_ = mqtt_topic(settings_.group, "NDATA", settings_.node);
        command_topic_ = mqtt_topic(settings_.group, "NCMD", settings_.node);
        const bool stays_here = settings_.address == "localhost" || settings_.address.starts_with("127.");
        if (!settings_.username.empty() && !settings_.tls && !stays_here)
            notices_.add(Text("the password goes to {}:{} unencrypted; set \"tls\": true", settings_.address,
                              settings_.port));
        static const int begun = mosquitto_lib_init();  // once a program
        (void)begun;
        thread_ = std::jthread([this](const std::stop_token& stop) { serve(stop); });
    }
    ~Mqtt() override {
        thread_.request_stop();
        thread_.join();
    }
    Mqtt(const Mqtt&) = delete;
    Mqtt& operator=(const Mqtt&) = delete;

    void publish(const LineState& state) override {
        const std::lock_guard lock(mutex_);
        if (state.results != state_.results) {
            measuring_ = given_up_ = false;
            enqueue(mqtt_result(state));
        }
        state_ = state;
        state_changed_ = true;
    }
    void alive() override {}

    std::optional<LineCall> take_call() override {
        const std::lock_guard lock(mutex_);
        if (!call_) return std::nullopt;
        const LineCall call = *std::exchange(call_, std::nullopt);
        if (std::chrono::nanoseconds(host_now_ns() - call.host_time_ns) > settings_.call_timeout) {
            refuse(call);
            return std::nullopt;
        }
        measuring_ = true;
        given_up_ = false;
        return call;
    }
    bool given_up() const override { return given_up_; }
    LinePart take_announced() override {
        const std::lock_guard lock(mutex_);
        return std::exchange(announced_, {});
    }
    bool starts_parts() const override { return settings_.line_starts; }
    bool connected() const override { return connected_; }
    std::vector<Text> take_notices() override { return notices_.take(); }

  private:
    static std::string dump(const json& value) {
        return value.dump(-1, ' ', false, json::error_handler_t::replace);
    }

    void enqueue(const json& result) {
        while (results_.size() >= settings_.queue) {
            if (lost_++ == 0)
                notices_.add(Text("the broker has been away for more than {} results; the oldest are dropped",
                                  settings_.queue));
            results_.pop_front();
            ++first_;
        }
        results_.push_back(dump(result));
    }

    // The call that nobody could follow.
    void refuse(const LineCall& call) {
        LineState refused = state_;
        refused.part = call.part;
        refused.part_id = call.part.id();
        refused.result = LineResult::not_measured;
        refused.alarm = LineAlarm::call_not_followed;
        refused.regions.clear();
        refused.run = 0;
        refused.seconds = 0;
        enqueue(mqtt_result(refused));
    }

    void serve(const std::stop_token& stop) {
        while (!stop.stop_requested()) {
            if (!client_ && !connect()) {
                std::this_thread::sleep_for(std::chrono::milliseconds(20));
                continue;
            }
            const int code = mosquitto_loop(client_, 20, 1);
            if (refused_ != 0) {
                drop(std::string(mosquitto_connack_string(refused_)));
            } else if (code != MOSQ_ERR_SUCCESS) {
                drop(code == MOSQ_ERR_ERRNO ? system_text(errno)
                                            : Text(std::string(mosquitto_strerror(code))));
            } else if (!connected_ && Clock::now() > give_up_) {
                drop("no answer in time");
            } else if (connected_) {
                send();
            }
            expire();
        }
        farewell();
        close();
    }

    void expire() {
        const std::lock_guard lock(mutex_);
        if (!call_ || std::chrono::nanoseconds(host_now_ns() - call_->host_time_ns) <= settings_.call_timeout)
            return;
        refuse(*std::exchange(call_, std::nullopt));
    }

    bool connect() {
        if (!backoff_.due()) return false;
        refused_ = 0;
        client_ = mosquitto_new(settings_.client_id.c_str(), true, this);
        if (!client_) {
            drop(system_text(errno));
            return false;
        }
        mosquitto_connect_callback_set(
            client_, [](mosquitto*, void* self, int code) { static_cast<Mqtt*>(self)->heard_connect(code); });
        mosquitto_publish_callback_set(
            client_, [](mosquitto*, void* self, int mid) { static_cast<Mqtt*>(self)->heard_publish(mid); });
        mosquitto_message_callback_set(client_, [](mosquitto*, void* self, const mosquitto_message* message) {
            static_cast<Mqtt*>(self)->heard_message(*message);
        });
        static const std::string kOffline = dump({{"version", kMqttVersion}, {"online", false}});
        int code = mosquitto_will_set(client_, state_topic_.c_str(), static_cast<int>(kOffline.size()),
                                      kOffline.data(), 1, true);
        if (code == MOSQ_ERR_SUCCESS && !settings_.username.empty())
            code =
                mosquitto_username_pw_set(client_, settings_.username.c_str(),
                                          settings_.password.empty() ? nullptr : settings_.password.c_str());
        const auto name_or_none = [](const std::string& s) { return s.empty() ? nullptr : s.c_str(); };
        if (code == MOSQ_ERR_SUCCESS && settings_.tls)
            code = mosquitto_tls_set(client_, settings_.ca_file.c_str(), nullptr,
                                     name_or_none(settings_.certificate_file),
                                     name_or_none(settings_.key_file), nullptr);
        if (code == MOSQ_ERR_SUCCESS)
            code = mosquitto_connect_async(client_, settings_.address.c_str(), settings_.port,
                                           settings_.keepalive_s);
        if (code != MOSQ_ERR_SUCCESS) {
            drop(code == MOSQ_ERR_ERRNO ? system_text(errno) : Text(std::string(mosquitto_strerror(code))));
            return false;
        }
        give_up_ = Clock::now() + settings_.timeout;
        return true;
    }

    void close() {
        if (client_) mosquitto_destroy(client_);
        client_ = nullptr;
        connected_ = false;
    }

    void drop(const Text& why) {
        if (!told_away_)
            notices_.add(
                Text("the broker at {}:{} does not answer: {}", settings_.address, settings_.port, why));
        told_away_ = true;
        close();
        backoff_.failed();
    }

    // A last will in an orderly way.
    void farewell() {
        if (!client_ || !connected_) return;
        send();
        if (const auto mid = say(state_topic_, dump({{"version", kMqttVersion}, {"online", false}})))
            flying_.push_back(*mid);
        const auto until = Clock::now() + std::chrono::milliseconds(500);
        while (!flying_.empty() && Clock::now() < until)
            if (mosquitto_loop(client_, 20, 1) != MOSQ_ERR_SUCCESS) return;
        mosquitto_disconnect(client_);
    }

    void heard_connect(int code) {
        refused_ = code;
        if (code != 0) return;
        connected_ = true;
        backoff_.worked();
        if (told_away_)
            notices_.add(Text("the broker at {}:{} answers again", settings_.address, settings_.port));
        told_away_ = false;
        mosquitto_subscribe(client_, nullptr, command_topic_.c_str(), 1);
        flights_.clear();
        flying_.clear();  // all that was not acknowledged is sent again
        const std::lock_guard lock(mutex_);
        state_changed_ = true;
        lost_ = 0;
        sent_ = first_;
    }

    // The results are acknowledged in their order; the state has no place in the queue.
    void heard_publish(int mid) {
        const auto state = std::find(flying_.begin(), flying_.end(), mid);
        if (state != flying_.end()) flying_.erase(state);
        const auto result =
            std::find_if(flights_.begin(), flights_.end(), [&](const auto& f) { return f.first == mid; });
        if (result == flights_.end()) return;
        const std::uint64_t number = result->second;
        flights_.erase(result);
        const std::lock_guard lock(mutex_);
        while (first_ <= number && !results_.empty()) {
            results_.pop_front();
            ++first_;
        }
        sent_ = std::max(sent_, first_);
    }

    void heard_message(const mosquitto_message& message) {
        if (message.retain) {
            notices_.add("a retained command is not obeyed; send it without retain");
            return;
        }
        const auto command = read_mqtt_command({static_cast<const char*>(message.payload),
                                                static_cast<std::size_t>(std::max(0, message.payloadlen))});
        if (!command) {
            notices_.add(Text("a command was not understood: {}", command.error().text()));
            return;
        }
        const std::lock_guard lock(mutex_);
        constexpr std::size_t kIdsKept = 1000;
        if (!obeyed_.insert(command->id).second) return;
        ids_.push_back(command->id);
        if (ids_.size() > kIdsKept) {
            obeyed_.erase(ids_.front());
            ids_.pop_front();
        }
        if (!command->start) {
            announced_ = command->part;
            return;
        }
        if (!settings_.line_starts) {
            notices_.add("a start of the line is not obeyed: the robot starts the parts here");
        } else if (!*command->start) {
            call_.reset();
            given_up_ = measuring_;
        } else if (measuring_) {
            notices_.add("a start of the line is not obeyed: a part is measured");
        } else {
            call_ = LineCall{command->part, host_now_ns()};
        }
    }

    // Never under our lock: libmosquitto holds its own while it calls us. nullopt: not taken, later again.
    std::optional<int> say(const std::string& topic, const std::string& text) {
        int mid = 0;
        if (mosquitto_publish(client_, &mid, topic.c_str(), static_cast<int>(text.size()), text.data(), 1,
                              true) != MOSQ_ERR_SUCCESS)
            return std::nullopt;
        return mid;
    }

    std::optional<std::string> changed_state() {
        const std::lock_guard lock(mutex_);
        if (!std::exchange(state_changed_, false)) return std::nullopt;
        return dump(mqtt_state(state_));
    }

    // The next result that was not sent, sent_ its number.
    std::optional<std::string> next_result() {
        const std::lock_guard lock(mutex_);
        sent_ = std::max(sent_, first_);
        if (sent_ - first_ >= results_.size()) return std::nullopt;
        return results_[sent_ - first_];
    }

    // A few at a time wait for their acknowledgement.
    void send() {
        constexpr std::size_t kFlights = 10;
        if (const auto state = changed_state()) {
            if (const auto mid = say(state_topic_, *state)) {
                flying_.push_back(*mid);
            } else {
                const std::lock_guard lock(mutex_);
                state_changed_ = true;
            }
        }
        while (flights_.size() < kFlights) {
            const auto result = next_result();
            if (!result) return;
            const auto mid = say(result_topic_, *result);
            if (!mid) return;
            flights_.emplace_back(*mid, sent_++);
        }
    }

    MqttSettings settings_;
    std::string state_topic_, result_topic_, command_topic_;
    LineNotices notices_;
    std::atomic<bool> connected_{false}, given_up_{false};

    // The link's thread alone.
    Backoff backoff_;
    mosquitto* client_ = nullptr;
    int refused_ = 0;
    bool told_away_ = false;
    Clock::time_point give_up_{};
    std::uint64_t sent_ = 0;                             // number of the next result to be sent
    std::deque<std::pair<int, std::uint64_t>> flights_;  // results that wait for their acknowledgement
    std::deque<int> flying_;                             // states that do

    // Both.
    mutable std::mutex mutex_;
    LineState state_;
    bool state_changed_ = true, measuring_ = false;
    std::deque<std::string> results_;
    std::uint64_t first_ = 0;  // number of results_.front()
    std::uint64_t lost_ = 0;
    std::set<std::string> obeyed_;  // ids of commands that came; the same again is a repetition
    std::deque<std::string> ids_;   // of those, in the order in which they came
    std::optional<LineCall> call_;
    LinePart announced_;

    std::jthread thread_;
};

}  // namespace

const SettingTable& mqtt_settings() {
    static const SettingTable table = entry::joined(
        {
            entry::text("address", "127.0.0.1", "of the broker"),
            entry::whole("port", 1883, 1, 65535, "8883 is usual with TLS"),
            entry::text("group", "seamwright", "of stations, in the topics"),
            entry::text("node", "", "this station in the topics; else the project's name"),
            entry::text("client_id", "", "another one for each station; else of group and node"),
            entry::text("username", "", ""),
            entry::text("password_env", "", "the environment variable that holds the password"),
            entry::text("password_file", "", "or the file whose first line it is"),
            entry::yes_no("tls", false, "encrypted"),
            entry::text("ca_file", "",
                        "PEM file that the broker's certificate is checked with; needed with tls"),
            entry::text("certificate_file", "",
                        "PEM file of this station's certificate, where the broker asks"),
            entry::text("key_file", "", "and its key"),
            entry::whole("keepalive_s", 10, 5, 3600, "a broker that is silent so long is away"),
            entry::whole("timeout_ms", 5000, 100, 60000, "to connect"),
            entry::whole("queue", 1000, 1, 100000, "results that wait while the broker is away"),
            entry::choice("start", {"robot", "line"},
                          "who starts a part; line: commands may, robot: they name the part of its call"),
            entry::whole("call_timeout_ms", 5000, 100, 600000,
                         "a start that the station cannot follow by then is answered"),
        },
        entry::reconnect(10, 500, 10000));
    return table;
}

Expected<std::unique_ptr<LineLink>> open_mqtt(const json& settings, const std::string& name) {
    SEAM_TRY(auto read, read_settings(settings, name));
    return std::make_unique<Mqtt>(std::move(read));
}

}  // namespace seamwright
