#pragma once
// Does the event loop stand still? A second thread asks it for an answer all the time.

#include <pthread.h>
#include <unistd.h>

#include <QMetaObject>
#include <QObject>
#include <QString>
#include <atomic>
#include <chrono>
#include <fstream>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace seamwright {

struct Freeze {
    double ms;       // that the thread computed or waited for something
    QString during;  // the deed before it
};

// Of the thread that makes it, as long as it lives. Time in which the thread would have run and the machine ran others does
// not count: what is left is the program's own, computing (the thread's clock) or waiting (it sleeps while an event is there).
class FreezeWatch {
  public:
    explicit FreezeWatch(double least_ms) : least_ms_(least_ms) {
        pthread_getcpuclockid(pthread_self(), &clock_);
        stat_ = "/proc/self/task/" + std::to_string(::gettid()) + "/stat";
        watcher_ = std::thread([this] { watch(); });
    }
    ~FreezeWatch() {
        ended_ = true;
        watcher_.join();
    }
    FreezeWatch(const FreezeWatch&) = delete;
    FreezeWatch& operator=(const FreezeWatch&) = delete;

    void during(const QString& deed) {
        const std::lock_guard lock(mutex_);
        deed_ = deed;
    }
    // What the test itself takes its time for.
    class Pause {
      public:
        explicit Pause(FreezeWatch* watch) : watch_(watch) {
            if (watch_) ++watch_->paused_;
        }
        ~Pause() {
            if (!watch_) return;
            ++watch_->pauses_;
            --watch_->paused_;
        }
        Pause(const Pause&) = delete;
        Pause& operator=(const Pause&) = delete;

      private:
        FreezeWatch* watch_;
    };
    std::vector<Freeze> freezes() const {
        const std::lock_guard lock(mutex_);
        return freezes_;
    }

  private:
    static constexpr std::chrono::milliseconds kLook{5};

    double cpu_ms() const {
        timespec t{};
        clock_gettime(clock_, &t);
        return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
    }
    bool sleeps() const {
        std::ifstream in(stat_);
        std::string text;
        std::getline(in, text);
        const std::size_t name = text.rfind(')');
        return name != std::string::npos && name + 2 < text.size() && text[name + 2] != 'R';
    }
    void watch() {
        while (!ended_) {
            answered_ = false;
            const int pauses = pauses_;
            const double before_ms = cpu_ms();
            double asleep_ms = 0;
            QMetaObject::invokeMethod(
                &anchor_, [this] { answered_ = true; }, Qt::QueuedConnection);
            bool paused = paused_ > 0;
            while (!answered_ && !ended_) {
                const auto from = std::chrono::steady_clock::now();
                std::this_thread::sleep_for(kLook);
                if (sleeps())
                    asleep_ms +=
                        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - from)
                            .count();
                paused = paused || paused_ > 0;
            }
            const double own_ms = cpu_ms() - before_ms + asleep_ms;
            if (own_ms >= least_ms_ && !paused && pauses == pauses_) {
                const std::lock_guard lock(mutex_);
                freezes_.push_back({own_ms, deed_});
            }
            std::this_thread::sleep_for(kLook);
        }
    }

    double least_ms_;
    clockid_t clock_{};
    std::string stat_;
    QObject anchor_;
    std::atomic<bool> answered_{false}, ended_{false};
    std::atomic<int> paused_{0}, pauses_{0};
    mutable std::mutex mutex_;
    QString deed_;
    std::vector<Freeze> freezes_;
    std::thread watcher_;
};

}  // namespace seamwright
