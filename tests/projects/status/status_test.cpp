// The status page, asked over a plain socket: what it says, who may ask, and what strangers send.

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <regex>
#include <thread>

#include "devices/capture/capture.h"
#include "projects/status/status_server.h"

namespace seamwright {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

class Wire {
  public:
    explicit Wire(int port) : handle_(::socket(AF_INET, SOCK_STREAM, 0)) {
        sockaddr_in at{};
        at.sin_family = AF_INET;
        at.sin_port = htons(static_cast<std::uint16_t>(port));
        at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        connected_ = ::connect(handle_, reinterpret_cast<const sockaddr*>(&at), sizeof at) == 0;
    }
    Wire(const Wire&) = delete;
    Wire& operator=(const Wire&) = delete;
    ~Wire() { ::close(handle_); }
    bool connected() const { return connected_; }
    void send(const std::string& bytes) const {
        (void)::send(handle_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    }
    // Until the other side closes, or says nothing for a while.
    std::string receive(int patience_ms = 3000) const {
        std::string all;
        pollfd wait{handle_, POLLIN, 0};
        char part[4096];
        while (::poll(&wait, 1, patience_ms) > 0) {
            const ssize_t n = ::recv(handle_, part, sizeof part, 0);
            if (n <= 0) break;
            all.append(part, static_cast<std::size_t>(n));
        }
        return all;
    }

  private:
    int handle_;
    bool connected_ = false;
};

WatchEvent run_done(int number, const std::string& part, const Eigen::Vector3d& xyz,
                    RunStatus status = RunStatus::ok) {
    auto record = std::make_shared<RunRecord>();
    record->number = number;
    record->part_id = part;
    record->status = status;
    record->message = "all regions are within their limits";
    RegionRecord region;
    region.region_id = "edge \"1\"";
    region.gate_passed = status == RunStatus::ok;
    region.correction.emplace();
    region.correction->status = CorrectionStatus::ok;
    region.correction->displacement.workobject_from_movedworkobject.translation() = xyz;
    region.correction->sigma_xyz_mm = {0.01, 0.02, 0.03};
    record->regions.push_back(region);
    WatchEvent e{utc_now(),
                 status == RunStatus::ok ? WatchLevel::info : WatchLevel::alarm,
                 watched::RunDone{record, 12.5},
                 Text("part {}: done", part),
                 WatchState::waiting,
                 {}};
    e.counts.parts = number;
    e.counts.corrected = number;
    return e;
}

class Status : public testing::Test {
  protected:
    void serve(const std::string& token = {}) {
        auto started = StatusServer::start(board_, {"127.0.0.1:0", token, Language::english});
        ASSERT_TRUE(started) << started.error().sentence();
        server_.emplace(std::move(*started));
    }
    std::string ask(const std::string& request) const {
        const Wire wire(server_->port());
        wire.send(request);
        return wire.receive();
    }
    std::string get(const std::string& path, const std::string& more = {},
                    const std::string& host = "127.0.0.1") const {
        return ask("GET " + path + " HTTP/1.1\r\nHost: " + host + "\r\nConnection: close\r\n" + more +
                   "\r\n");
    }
    static std::string body_of(const std::string& answer) {
        return answer.substr(answer.find("\r\n\r\n") + 4);
    }

    StatusBoard board_{"door <left>", "Seamwright test", true};
    std::optional<StatusServer> server_;
};

TEST_F(Status, TellsStatePartsAlarmsAndFigures) {
    serve();
    for (int i = 1; i <= 5; ++i) board_.take(run_done(i, fmt::format("car {}", i), {0.5 * i, -1, 2}));
    board_.take(run_done(6, "car 6", {9, 9, 9}, RunStatus::alarm));
    const auto state = nlohmann::json::parse(body_of(get("/api/state")));
    EXPECT_EQ(state["state"], "waiting");
    EXPECT_EQ(state["counts"]["parts"], 6);
    const auto parts = nlohmann::json::parse(body_of(get("/api/parts")));
    ASSERT_EQ(parts.size(), 6u);
    EXPECT_EQ(parts[0]["part"], "car 6");
    EXPECT_EQ(parts[1]["regions"][0]["xyz_mm"][0], 2.5);
    const auto alarms = nlohmann::json::parse(body_of(get("/api/alarms")));
    ASSERT_EQ(alarms.size(), 1u);
    EXPECT_EQ(alarms[0]["level"], "alarm");
    const std::string page = get("/");
    EXPECT_THAT(page, StartsWith("HTTP/1.1 200"));
    EXPECT_THAT(page, HasSubstr("<svg"));
    EXPECT_THAT(page, HasSubstr("http-equiv=\"refresh\""));
    EXPECT_THAT(page, Not(HasSubstr("<script")));
    EXPECT_THAT(get("/health"), HasSubstr("\r\n\r\nok\n"));
}

// Each line is a comment or name{label="value",...} number, as Prometheus reads it.
TEST_F(Status, MetricsAreWhatPrometheusReads) {
    serve();
    board_.take(run_done(1, "car", {0.5, -1, std::nan("")}));
    const std::string metrics = body_of(get("/metrics"));
    const std::regex line(
        R"((# (HELP|TYPE) [a-z_]+ .+)|([a-z_]+(\{([a-z]+="([^"\\\n]|\\.)*",?)+\})? (NaN|[-+0-9.e]+)))");
    std::istringstream lines(metrics);
    for (std::string text; std::getline(lines, text);) EXPECT_TRUE(std::regex_match(text, line)) << text;
    EXPECT_THAT(metrics, HasSubstr("seamwright_parts_total 1\n"));
    EXPECT_THAT(metrics, HasSubstr(R"(seamwright_last_displacement_mm{region="edge \"1\"",axis="y"} -1)"));
    EXPECT_THAT(metrics, HasSubstr("axis=\"z\"} NaN"));
    EXPECT_THAT(metrics, HasSubstr("seamwright_state{state=\"waiting\"} 1\n"));
}

// What a robot calls a part is not trusted.
TEST_F(Status, NamesOfPartsStayNames) {
    serve();
    board_.take(run_done(1, "<script>alert(1)</script>\xff", {1, 2, 3}));
    const std::string page = get("/");
    EXPECT_THAT(page, Not(HasSubstr("<script>")));
    EXPECT_THAT(page, Not(HasSubstr("<left>")));
    EXPECT_TRUE(nlohmann::json::accept(body_of(get("/api/parts"))));
}

TEST_F(Status, OnlyReads) {
    serve();
    for (const char* method : {"POST", "PUT", "DELETE", "OPTIONS", "TRACE"})
        EXPECT_THAT(ask(std::string(method) +
                        " / HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 0\r\nConnection: close\r\n\r\n"),
                    StartsWith("HTTP/1.1 405"))
            << method;
    EXPECT_THAT(get("/etc/passwd"), StartsWith("HTTP/1.1 404"));
    EXPECT_THAT(get("/../../etc/passwd"), StartsWith("HTTP/1.1 404"));
    const std::string head = ask("HEAD /health HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
    EXPECT_THAT(head, StartsWith("HTTP/1.1 200"));
    EXPECT_THAT(head, HasSubstr("Content-Length: 3"));
    EXPECT_EQ(body_of(head), "");
}

TEST_F(Status, OnThisComputerForThisComputer) {
    serve();
    EXPECT_THAT(get("/", "", "localhost:8080"), StartsWith("HTTP/1.1 200"));
    EXPECT_THAT(get("/", "", "[::1]:8080"), StartsWith("HTTP/1.1 200"));
    // A page of elsewhere whose name was pointed at this computer.
    for (const char* host : {"evil.example", "127.0.0.1.evil.example", "", "localhost.evil.example:8080"})
        EXPECT_THAT(get("/", "", host), StartsWith("HTTP/1.1 403")) << host;
}

TEST_F(Status, ATokenWhereItIsAskedFor) {
    const std::string token = "0123456789abcdef";
    serve(token);
    EXPECT_THAT(get("/metrics"), StartsWith("HTTP/1.1 401"));
    EXPECT_THAT(get("/metrics", "Authorization: Bearer 0123456789abcdeX\r\n"), StartsWith("HTTP/1.1 401"));
    EXPECT_THAT(get("/metrics", "Authorization: Bearer 0123456789abcde\r\n"), StartsWith("HTTP/1.1 401"));
    EXPECT_THAT(get("/metrics", "Authorization: Bearer 0123456789abcdef0\r\n"), StartsWith("HTTP/1.1 401"));
    EXPECT_THAT(get("/?xtoken=" + token), StartsWith("HTTP/1.1 401"));
    EXPECT_THAT(get("/metrics", "Authorization: Bearer " + token + "\r\n", "cell-7"),
                StartsWith("HTTP/1.1 200"));
    EXPECT_THAT(get("/?a=b&token=" + token), StartsWith("HTTP/1.1 200"));
    for (const char* address : {"0.0.0.0:0", "[::]:0"}) {
        const auto open = StatusServer::start(board_, {address, "", Language::english});
        ASSERT_FALSE(open) << address;
        EXPECT_EQ(open.error().kind, ErrorKind::usage);
        EXPECT_FALSE(StatusServer::start(board_, {address, "short", Language::english}));
    }
}

TEST_F(Status, AddressesThatAreNoneAreRefused) {
    for (const char* address : {"", "8080", "127.0.0.1", "127.0.0.1:", "127.0.0.1:99999", "127.0.0.1:80x",
                                "127.0.0.1:-1", "localhost:8080", ":::", "[::1:80"}) {
        const auto started = StatusServer::start(board_, {address, "", Language::english});
        ASSERT_FALSE(started) << address;
        EXPECT_EQ(started.error().kind, ErrorKind::usage) << address;
    }
    serve();
    const auto taken =
        StatusServer::start(board_, {fmt::format("127.0.0.1:{}", server_->port()), "", Language::english});
    ASSERT_FALSE(taken);
    EXPECT_EQ(taken.error().kind, ErrorKind::device);
}

TEST_F(Status, StrangersGetAnAnswerAndTheNextOneToo) {
    serve();
    EXPECT_THAT(ask("GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nX: " + std::string(20000, 'a') + "\r\n\r\n"),
                StartsWith("HTTP/1.1 431"));
    EXPECT_THAT(ask(std::string(4000, '\xff') + "\r\n\r\n"), StartsWith("HTTP/1.1 400"));
    EXPECT_THAT(ask("\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03\r\n\r\n"), StartsWith("HTTP/1.1 400"));
    EXPECT_THAT(ask("GET / HTTP/9.9\r\n\r\n"), StartsWith("HTTP/1.1 400"));
    EXPECT_THAT(ask("POST / HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 99999999999\r\n\r\nabc"),
                testing::AnyOf(StartsWith("HTTP/1.1 4"), testing::IsEmpty()));
    EXPECT_THAT(
        ask("GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nTransfer-Encoding: chunked\r\n\r\nFFFFFFFFFFFFFFFF\r\n"),
        testing::AnyOf(StartsWith("HTTP/1.1 4"), StartsWith("HTTP/1.1 200")));
    // Two requests in one packet are two answers.
    const Wire two(server_->port());
    two.send(
        "GET /health HTTP/1.1\r\nHost: localhost\r\n\r\nGET /health HTTP/1.1\r\nHost: "
        "localhost\r\nConnection: close\r\n\r\n");
    const std::string both = two.receive();
    EXPECT_NE(both.find("HTTP/1.1 200", 1), std::string::npos);
    {
        const Wire gone(server_->port());
        gone.send("GET / HT");
    }
    EXPECT_THAT(get("/health"), StartsWith("HTTP/1.1 200"));
}

TEST_F(Status, SilentStrangersTakeNoMoreThanTheirShare) {
    serve();
    std::vector<std::unique_ptr<Wire>> silent;
    for (int i = 0; i < 60; ++i) silent.push_back(std::make_unique<Wire>(server_->port()));
    silent.clear();
    // As soon as they have gone, there is room again.
    std::string answer;
    for (int i = 0; i < 100 && answer.empty(); ++i) {
        answer = get("/health");
        if (answer.empty()) std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    EXPECT_THAT(answer, StartsWith("HTTP/1.1 200"));
    // And it goes at once while somebody holds the line.
    const Wire holding(server_->port());
    server_.reset();
    EXPECT_EQ(holding.receive(), "");
}

TEST_F(Status, KeepsTheLastPartsWhileItIsAsked) {
    serve();
    std::jthread teller([&] {
        for (int i = 1; i <= 2000; ++i) board_.take(run_done(i, "car", {1.0 * i, 0, 0}));
    });
    for (int i = 0; i < 20; ++i) EXPECT_TRUE(nlohmann::json::accept(body_of(get("/api/parts"))));
    teller.join();
    const auto parts = nlohmann::json::parse(body_of(get("/api/parts")));
    EXPECT_EQ(parts.size(), kStatusParts);
    EXPECT_EQ(parts[0]["run"], 2000);
    EXPECT_THAT(body_of(get("/metrics")), HasSubstr("seamwright_runs_total{status=\"ok\"} 2000\n"));
}

}  // namespace
}  // namespace seamwright
