#include "projects/status/status_server.h"

#include <fmt/format.h>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/strand.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <charconv>
#include <optional>
#include <thread>

#include "core/system_text.h"

namespace seamwright {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
using asio::ip::tcp;

constexpr std::size_t kLongestHeader = 8192;
constexpr int kMostConnections = 32;
constexpr std::size_t kShortestToken = 16;
constexpr std::chrono::seconds kSilence{10};

using Request = http::request<http::empty_body>;
using Response = http::response<http::string_body>;

std::string_view view_of(beast::string_view text) {
    return {text.data(), text.size()};
}

// Takes as long whatever differs.
bool same_token(std::string_view given, std::string_view token) {
    unsigned differs = given.size() != token.size();
    for (std::size_t i = 0; i < token.size(); ++i)
        differs |= static_cast<unsigned char>(token[i]) ^
                   static_cast<unsigned char>(i < given.size() ? given[i] : '\0');
    return differs == 0;
}

bool names_loopback(std::string_view host) {
    if (const auto bracket = host.find(']'); host.starts_with('[') && bracket != host.npos)
        host = host.substr(1, bracket - 1);
    else
        host = host.substr(0, host.find(':'));
    return host == "127.0.0.1" || host == "localhost" || host == "::1";
}

class Answerer {
  public:
    Answerer(StatusPages pages, const StatusServerOptions& options, bool loopback)
        : pages_(std::move(pages)), options_(options), loopback_(loopback) {}

    Response answer(const Request& request) const {
        const std::string_view target = view_of(request.target());
        const std::string_view path = target.substr(0, target.find('?'));
        if (!may(request, target))
            return loopback_ && options_.token.empty()
                       ? plain(request, http::status::forbidden, "not this host\n")
                       : plain(request, http::status::unauthorized, "no token\n");
        if (request.method() != http::verb::get && request.method() != http::verb::head) {
            Response refused = plain(request, http::status::method_not_allowed, "read-only\n");
            refused.set(http::field::allow, "GET, HEAD");
            return refused;
        }
        if (path == "/health") return plain(request, http::status::ok, "ok\n");
        if (const auto page = pages_.find(path); page != pages_.end())
            return made(request, http::status::ok, page->second.type, page->second.body());
        return plain(request, http::status::not_found, "there is no such page\n");
    }

    static Response made(const Request& request, http::status status, const char* type, std::string body) {
        Response response(status, 11);
        response.set(http::field::content_type, type);
        response.set(http::field::cache_control, "no-store");
        response.set("X-Content-Type-Options", "nosniff");
        response.set("Referrer-Policy", "no-referrer");  // the token may stand in the address
        response.set("Content-Security-Policy",
                     "default-src 'none'; style-src 'unsafe-inline'; img-src data:; frame-ancestors 'none'");
        response.keep_alive(request.keep_alive() && status == http::status::ok);
        response.body() = std::move(body);
        response.content_length(response.body().size());
        if (request.method() == http::verb::head) response.body().clear();
        return response;
    }
    static Response plain(const Request& request, http::status status, std::string body) {
        Response response = made(request, status, "text/plain; charset=utf-8", std::move(body));
        if (status == http::status::unauthorized)
            response.set(http::field::www_authenticate, "Bearer realm=\"seamwright\"");
        return response;
    }

  private:
    bool may(const Request& request, std::string_view target) const {
        if (options_.token.empty()) return loopback_ && names_loopback(view_of(request[http::field::host]));
        const std::string_view header = view_of(request[http::field::authorization]);
        constexpr std::string_view kBearer = "Bearer ";
        if (header.starts_with(kBearer)) return same_token(header.substr(kBearer.size()), options_.token);
        const auto query = target.find('?');
        if (query == target.npos) return false;
        constexpr std::string_view kToken = "token=";
        for (std::string_view rest = target.substr(query + 1); !rest.empty();) {
            const std::string_view one = rest.substr(0, rest.find('&'));
            if (one.starts_with(kToken)) return same_token(one.substr(kToken.size()), options_.token);
            rest.remove_prefix(std::min(rest.size(), one.size() + 1));
        }
        return false;
    }

    StatusPages pages_;
    StatusServerOptions options_;
    bool loopback_;
};

class Session : public std::enable_shared_from_this<Session> {
  public:
    Session(tcp::socket socket, const Answerer& answerer, int& open)
        : stream_(std::move(socket)), answerer_(answerer), open_(open) {
        ++open_;
    }
    ~Session() { --open_; }
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

    void read() {
        parser_.emplace();
        parser_->header_limit(kLongestHeader);
        parser_->body_limit(0);
        stream_.expires_after(kSilence);
        http::async_read(
            stream_, buffer_, *parser_,
            [self = shared_from_this()](beast::error_code error, std::size_t) { self->read_done(error); });
    }

  private:
    void read_done(beast::error_code error) {
        if (error == http::error::end_of_stream || error == beast::error::timeout ||
            error == asio::error::eof || error == asio::error::connection_reset ||
            error == asio::error::operation_aborted)
            return close();
        if (error) {
            Request none;
            none.keep_alive(false);
            const bool long_header =
                error == http::error::header_limit || error == http::error::buffer_overflow;
            return write(Answerer::plain(
                none, long_header ? http::status::request_header_fields_too_large : http::status::bad_request,
                "not understood\n"));
        }
        write(answerer_.answer(parser_->get()));
    }

    void write(Response response) {
        response_ = std::move(response);
        stream_.expires_after(kSilence);
        // The length of what HEAD does not get is told all the same.
        http::async_write(stream_, response_,
                          [self = shared_from_this()](beast::error_code error, std::size_t) {
                              if (error || !self->response_.keep_alive()) return self->close();
                              self->read();
                          });
    }

    void close() {
        beast::error_code ignored;
        stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
    }

    beast::tcp_stream stream_;
    beast::flat_buffer buffer_{kLongestHeader + 4096};
    std::optional<http::request_parser<http::empty_body>> parser_;
    Response response_;
    const Answerer& answerer_;
    int& open_;
};

Expected<tcp::endpoint> endpoint_of(const std::string& text) {
    const auto wrong = [&] {
        return usage_error(Text("\"{}\" is no address", text), "--status",
                           "write 127.0.0.1:8080 or [::1]:8080");
    };
    const auto colon = text.rfind(':');
    if (colon == std::string::npos) return wrong();
    std::string host = text.substr(0, colon);
    if (host.size() > 2 && host.front() == '[' && host.back() == ']') host = host.substr(1, host.size() - 2);
    unsigned port = 0;
    const char *first = text.data() + colon + 1, *last = text.data() + text.size();
    const auto [end, failed] = std::from_chars(first, last, port);
    beast::error_code error;
    const auto address = asio::ip::make_address(host, error);
    if (error || failed != std::errc() || end != last || port > 65535) return wrong();
    return tcp::endpoint(address, static_cast<unsigned short>(port));
}

}  // namespace

struct StatusServer::Impl {
    Impl(StatusPages pages, const StatusServerOptions& options, bool loopback)
        : answerer(std::move(pages), options, loopback) {}
    ~Impl() {
        context.stop();
        if (thread.joinable()) thread.join();
    }
    void accept() {
        acceptor.async_accept([this](beast::error_code error, tcp::socket socket) {
            if (error == asio::error::operation_aborted) return;
            if (!error && open < kMostConnections)
                std::make_shared<Session>(std::move(socket), answerer, open)->read();
            if (!error) return accept();
            // No descriptors left, or the like: not at full speed.
            pause.expires_after(std::chrono::milliseconds(100));
            pause.async_wait([this](beast::error_code stopped) {
                if (!stopped) accept();
            });
        });
    }

    Answerer answerer;
    int open = 0;
    asio::io_context context{1};
    tcp::acceptor acceptor{context};
    asio::steady_timer pause{context};
    std::thread thread;
};

StatusServer::StatusServer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
StatusServer::StatusServer(StatusServer&&) noexcept = default;
StatusServer::~StatusServer() = default;

int StatusServer::port() const {
    return impl_->acceptor.local_endpoint().port();
}

StatusPage json_page(std::function<nlohmann::json()> value) {
    return {"application/json", [value = std::move(value)] {
                return value().dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
            }};
}

Expected<StatusServer> StatusServer::start(const StatusBoard& board, const StatusServerOptions& options) {
    return start({{"/api/state", json_page([&board] { return status_json(board.view()); })},
                  {"/api/parts", json_page([&board] { return status_parts_json(board.view()); })},
                  {"/api/alarms", json_page([&board] { return status_alarms_json(board.view()); })},
                  {"/metrics", {kMetricsPage, [&board] { return status_metrics(board.view()); }}},
                  {"/",
                   {kHtmlPage,
                    [&board, language = options.language] { return status_page(board.view(), language); }}}},
                 options);
}

Expected<StatusServer> StatusServer::start(StatusPages pages, const StatusServerOptions& options) {
    SEAM_TRY(const auto endpoint, endpoint_of(options.address));
    const bool loopback = endpoint.address().is_loopback();
    if ((!loopback || !options.token.empty()) && options.token.size() < kShortestToken)
        return usage_error(Text("{} needs a token of at least {} signs", options.address, kShortestToken),
                           "--status", "give --status-token FILE, or an address of this computer, 127.0.0.1");
    auto impl = std::make_unique<Impl>(std::move(pages), options, loopback);
    beast::error_code error;
    impl->acceptor.open(endpoint.protocol(), error);
    if (!error) impl->acceptor.set_option(asio::socket_base::reuse_address(true), error);
    if (!error) impl->acceptor.bind(endpoint, error);
    if (!error) impl->acceptor.listen(kMostConnections, error);
    if (error)
        return device_error(Text("the status page cannot be served: {}", system_text(error)), options.address,
                            "choose another port");
    impl->accept();
    impl->thread = std::thread([context = &impl->context] { context->run(); });
    return StatusServer(std::move(impl));
}

}  // namespace seamwright
