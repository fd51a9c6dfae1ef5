#include "devices/drawing/apart.h"

#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <type_traits>

namespace seamwright::drawing {
namespace {

constexpr int kLookMs = 50;  // how often somebody may have cancelled

// Both ends are this program: values as they lie in memory.
class Packing {
  public:
    std::string bytes;
    template <class T>
    requires std::is_trivially_copyable_v<T>
    void operator()(const T& v) { bytes.append(reinterpret_cast<const char*>(&v), sizeof v); }
    void operator()(const std::string& v) {
        (*this)(v.size());
        bytes += v;
    }
    void operator()(const Eigen::Vector3d& v) {
        bytes.append(reinterpret_cast<const char*>(v.data()), 3 * sizeof(double));
    }
    void operator()(const Eigen::Vector3i& v) {
        bytes.append(reinterpret_cast<const char*>(v.data()), 3 * sizeof(int));
    }
    void operator()(const Text& v) {
        (*this)(v.key());
        (*this)(v.arguments().size());
        for (const Text::Argument& a : v.arguments()) {
            (*this)(a.index());
            std::visit([&](const auto& value) { (*this)(value); }, a);
        }
    }
    template <class T>
    void operator()(const std::vector<T>& v) {
        (*this)(v.size());
        for (const T& item : v) (*this)(item);
    }
    void operator()(const DrawingFace& f) { each(f, *this); }
    void operator()(const DrawingPoint& p) { each(p, *this); }
    void operator()(const DrawingEdge& e) { each(e, *this); }
    template <class Visitor>
    static void each(auto& v, Visitor& visit) {
        using T = std::remove_cvref_t<decltype(v)>;
        if constexpr (std::is_same_v<T, DrawingFace>) {
            visit(v.id), visit(v.kind), visit(v.area_mm2), visit(v.radius_mm), visit(v.triangle),
                visit(v.triangles);
        } else if constexpr (std::is_same_v<T, DrawingPoint>) {
            visit(v.point_mm), visit(v.tangent), visit(v.normal_left), visit(v.normal_right),
                visit(v.radius_mm), visit(v.arc_mm);
        } else if constexpr (std::is_same_v<T, DrawingEdge>) {
            visit(v.id), visit(v.kind), visit(v.left), visit(v.right), visit(v.length_mm), visit(v.closed),
                visit(v.fold_deg), visit(v.convex), visit(v.points);
        } else {
            visit(v.source), visit(v.form), visit(v.unit), visit(v.chord_mm), visit(v.mesh.vertices),
                visit(v.mesh.triangles), visit(v.normals), visit(v.faces), visit(v.edges),
                visit(v.volume_mm3);
        }
    }
};

// Precondition: what Packing wrote, whole.
class Unpacking {
  public:
    explicit Unpacking(std::string_view bytes) : at_(bytes.data()) {}
    template <class T>
    requires std::is_trivially_copyable_v<T>
    void operator()(T& v) { take(&v, sizeof v); }
    void operator()(std::string& v) {
        v.resize(size());
        take(v.data(), v.size());
    }
    void operator()(Eigen::Vector3d& v) { take(v.data(), 3 * sizeof(double)); }
    void operator()(Eigen::Vector3i& v) { take(v.data(), 3 * sizeof(int)); }
    void operator()(Text& v) {
        std::string key;
        (*this)(key);
        std::vector<Text::Argument> arguments(size());
        for (Text::Argument& a : arguments) {
            switch (size()) {
                case 0:
                    (*this)(a.emplace<0>());
                    break;
                case 1:
                    (*this)(a.emplace<1>());
                    break;
                case 2:
                    (*this)(a.emplace<2>());
                    break;
                default:
                    (*this)(a.emplace<3>());
            }
        }
        if (auto text = Text::from(std::move(key), std::move(arguments))) v = *std::move(text);
    }
    template <class T>
    void operator()(std::vector<T>& v) {
        v.resize(size());
        for (T& item : v) (*this)(item);
    }
    void operator()(DrawingFace& f) { Packing::each(f, *this); }
    void operator()(DrawingPoint& p) { Packing::each(p, *this); }
    void operator()(DrawingEdge& e) { Packing::each(e, *this); }

  private:
    std::size_t size() {
        std::size_t n = 0;
        take(&n, sizeof n);
        return n;
    }
    void take(void* to, std::size_t n) {
        if (n > 0) std::memcpy(to, at_, n);
        at_ += n;
    }
    const char* at_;
};

// A message: a letter, its length, its bytes.
bool send(int pipe, char letter, const std::string& bytes) {
    std::string all(1, letter);
    const std::size_t n = bytes.size();
    all.append(reinterpret_cast<const char*>(&n), sizeof n);
    all += bytes;
    for (std::size_t sent = 0; sent < all.size();) {
        const ssize_t now = write(pipe, all.data() + sent, all.size() - sent);
        if (now < 0 && errno == EINTR) continue;
        if (now <= 0) return false;
        sent += static_cast<std::size_t>(now);
    }
    return true;
}

[[noreturn]] void answer_in_child(int pipe, const DrawingOptions& options,
                                  const std::function<Expected<Drawing>(const DrawingOptions&)>& read) {
    const rlimit none{0, 0};
    setrlimit(RLIMIT_CORE, &none);  // its end is expected
    for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGABRT, SIGILL}) std::signal(signal, SIG_DFL);
    DrawingOptions mine = options;
    mine.cancel = {};
    mine.progress = [pipe](double share, const Text& what) {
        Packing packing;
        packing(share);
        packing(what);
        if (!send(pipe, 'P', packing.bytes)) _exit(1);
    };
    const auto drawing = read(mine);
    Packing packing;
    if (drawing) {
        Packing::each(*drawing, packing);
    } else {
        const Error& e = drawing.error();
        packing(e.kind), packing(e.code), packing(e.what), packing(e.where), packing(e.mend);
    }
    _exit(send(pipe, drawing ? 'D' : 'E', packing.bytes) ? 0 : 1);
}

struct Child {
    pid_t id = -1;
    int pipe = -1;
    ~Child() {
        close(pipe);
        kill(id, SIGKILL);  // it is ours until waitpid() has taken it
        while (waitpid(id, nullptr, 0) < 0 && errno == EINTR) {
        }
    }
};

// The message at the front of `bytes`; its length, 0 where it is not whole yet.
std::size_t whole_message(std::string_view bytes) {
    std::size_t n = 0;
    if (bytes.size() < 1 + sizeof n) return 0;
    std::memcpy(&n, bytes.data() + 1, sizeof n);
    return bytes.size() < 1 + sizeof n + n ? 0 : 1 + sizeof n + n;
}

}  // namespace

Expected<Drawing> read_apart(const std::string& name, const DrawingOptions& options,
                             const std::function<Expected<Drawing>(const DrawingOptions&)>& read) {
    int ends[2];
    if (pipe(ends) != 0) return device_error("no process could be made to read it", name);
    const pid_t id = fork();
    if (id == 0) {
        close(ends[0]);
        answer_in_child(ends[1], options, read);
    }
    close(ends[1]);
    if (id < 0) {
        close(ends[0]);
        return device_error("no process could be made to read it", name);
    }
    const Child child{id, ends[0]};
    using Clock = std::chrono::steady_clock;
    const auto patience = std::chrono::duration<double>(options.patience_s);
    auto heard = Clock::now();
    std::string bytes;
    std::vector<char> buffer(std::size_t{1} << 16);
    for (;;) {
        if (options.cancel.stop_requested())
            return tl::unexpected(Error{ErrorKind::usage, "cancelled", name, {}, ErrorCode::cancelled});
        pollfd ready{child.pipe, POLLIN, 0};
        if (poll(&ready, 1, kLookMs) <= 0) {
            if (Clock::now() - heard < patience) continue;
            return file_error(
                Text("is damaged or too large: OpenCASCADE came to no end over it in {:.0f} s",
                     options.patience_s),
                name, "export it again from the drawing program, a part of it alone where it is large");
        }
        heard = Clock::now();
        const ssize_t n = ::read(child.pipe, buffer.data(), buffer.size());
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0)
            return file_error("is damaged: OpenCASCADE broke down over it", name,
                              "export it again from the drawing program");
        bytes.append(buffer.data(), static_cast<std::size_t>(n));
        while (const std::size_t length = whole_message(bytes)) {
            const char letter = bytes[0];
            Unpacking unpacking(std::string_view(bytes).substr(1 + sizeof length));
            if (letter == 'D') {
                Drawing drawing;
                Packing::each(drawing, unpacking);
                if (options.progress) options.progress(1, "read");
                return drawing;
            }
            if (letter == 'E') {
                Error e;
                unpacking(e.kind), unpacking(e.code), unpacking(e.what), unpacking(e.where),
                    unpacking(e.mend);
                return tl::unexpected(e);
            }
            double share = 0;
            Text what;
            unpacking(share), unpacking(what);
            if (options.progress) options.progress(share, what);
            bytes.erase(0, length);
        }
    }
}

}  // namespace seamwright::drawing
