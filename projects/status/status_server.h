#pragma once
// The status board over HTTP, for browsers and for what collects figures. Read-only: GET and HEAD, nothing else.
//     /  the page      /api/state  /api/parts  /api/alarms  JSON      /metrics  Prometheus text      /health  "ok"
//
// Who may ask. On a loopback address everybody on this computer, if the request names a loopback host (else a page of
// elsewhere could read it through a browser: DNS rebinding). On any other address only who shows the token:
// "Authorization: Bearer TOKEN", or "?token=TOKEN" for a browser. The connection is not encrypted; beyond the plant's
// own network a proxy has to do that.
//
// A stranger costs little: 8 KiB of header, no body, 10 s of silence, 32 connections, of which the next is closed at
// once. One thread; the watching never waits for it.

#include <memory>
#include <string>

#include "core/error.h"
#include "projects/status/status_board.h"

namespace seamwright {

struct StatusServerOptions {
    std::string address = "127.0.0.1:8080";  // "[::1]:8080"; port 0: a free one
    std::string token;                       // at least 16 signs where the address is not loopback
    Language language = Language::english;
};

class StatusServer {
  public:
    // Error (usage): no address, no token where one is needed; (device): the port is taken.
    static Expected<StatusServer> start(const StatusBoard& board, const StatusServerOptions& options);
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
