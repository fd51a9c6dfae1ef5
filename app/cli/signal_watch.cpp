#include "app/cli/signal_watch.h"

#include <chrono>
#include <csignal>
#include <thread>

namespace seamwright::cli {
namespace {

volatile std::sig_atomic_t g_signalled = 0;
void on_signal(int) {
    g_signalled = 1;
}

// A signal handler may not touch a stop_source; this thread watches the flag for it.
class SignalWatch {
  public:
    SignalWatch() {
        std::signal(SIGINT, on_signal);
        std::signal(SIGTERM, on_signal);
        thread_ = std::jthread([this](const std::stop_token& done) {
            while (!done.stop_requested()) {
                if (g_signalled) source_.request_stop();
                std::this_thread::sleep_for(std::chrono::milliseconds(20));
            }
        });
    }
    std::stop_token token() const { return source_.get_token(); }

  private:
    std::stop_source source_;
    std::jthread thread_;
};

}  // namespace

std::stop_token stop_on_signal() {
    static const SignalWatch watch;
    return watch.token();
}

}  // namespace seamwright::cli
