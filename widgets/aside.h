#pragma once
// Work that the window does not wait for: made on a thread of its own, taken on the window's thread.

#include <QMetaObject>
#include <QObject>
#include <QThreadPool>
#include <atomic>
#include <memory>
#include <type_traits>
#include <utility>

namespace seamwright {

// One thing at a time, the newest counts: what was asked for before is not begun any more, or what it made is dropped. The
// owner lives on a thread with an event loop; its end waits for what is under way, so `make` may refer to what outlives it.
// `make` touches nothing of the window; whatever it gives is what `done` gets.
class Aside : public QObject {
  public:
    Aside() { pool_.setMaxThreadCount(1); }
    ~Aside() override {
        drop();
        pool_.waitForDone();
    }
    template <class Make, class Done>
    void run(Make make, Done done) {
        const int mine = ++newest_;
        pool_.start([this, mine, make = std::move(make), done = std::move(done)] {
            if (mine != newest_) return;
            auto made = std::make_shared<std::invoke_result_t<const Make&>>(make());
            QMetaObject::invokeMethod(
                this,
                [this, mine, made, done] {
                    if (mine == newest_) done(std::move(*made));
                },
                Qt::QueuedConnection);
        });
    }
    void drop() { ++newest_; }  // nothing of what was asked for is taken any more

  private:
    std::atomic<int> newest_ = 0;
    QThreadPool pool_;
};

}  // namespace seamwright
