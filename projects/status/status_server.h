#pragma once
// The status board, or other pages, over HTTP, for browsers and for what collects figures. Read-only: GET and HEAD, nothing else.
//     /  the page      /api/state  /api/parts  /api/alarms  JSON      /metrics  Prometheus text      /health  "ok"
//
// Who may ask. On a loopback address everybody on this computer, if the request names a loopback host (else a page of
// elsewhere could read it through a browser: DNS rebinding). On any other address only who shows the token:
// "Authorization: Bearer TOKEN", or "?token=TOKEN" for a browser. The connection is not encrypted; beyond the plant's
// own network a proxy has to do that.
//
// A stranger costs little: 8 KiB of header, no body, 10 s of silence, 32 connections, of which the next is closed at
// once. One thread; the watching never waits for it.

#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "core/error.h"
#include "projects/status/status_board.h"

namespace seamwright {

// What is served under a path ("/", "/api/state"); made anew for each who asks, on the server's thread.
struct StatusPage {
    const char* type;  // "application/json"
    std::function<std::string()> body;
};
using StatusPages = std::map<std::string, StatusPage, std::less<>>;
inline constexpr const char* kHtmlPage = "text/html; charset=utf-8";
inline constexpr const char* kMetricsPage = "text/plain; version=0.0.4; charset=utf-8";
// Names of parts are any bytes that a robot sends.
StatusPage json_page(std::function<nlohmann::json()> value);

struct StatusServerOptions {
    std::string address = "127.0.0.1:8080";  // "[::1]:8080"; port 0: a free one
    std::string token;                       // at least 16 signs where the address is not loopback
    Language language = Language::english;
};

class StatusServer {
  public:
    // Error (usage): no address, no token where one is needed; (device): the port is taken.
    static Expected<StatusServer> start(const StatusBoard& board, const StatusServerOptions& options);
    // Other pages; /health is always there.
    static Expected<StatusServer> start(StatusPages pages, const StatusServerOptions& options);
    StatusServer(StatusServer&&) noexcept;
    StatusServer& operator=(StatusServer&&) = delete;
    ~StatusServer();
    int port() const;

  private:
    struct Impl;
    explicit StatusServer(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace seamwright
