#include "viewer/gate.hpp"

#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "support/catch.hpp"

using namespace pliant::viewer;

namespace {

const std::string token = "0123456789abcdef0123456789abcdef";
const Gate gate(token, 8080, view_routes());

using Verdict = std::variant<ViewRoute, Refusal>;

Verdict judge(const std::string& target, std::vector<HttpField> fields = {},
              const std::string& method = "GET", const std::string& host = "127.0.0.1:8080") {
  HttpHead head;
  head.method = method;
  head.target = target;
  head.fields = std::move(fields);
  head.fields.push_back({"host", host});
  const auto judged = gate.judge(head);
  if (const auto* refusal = std::get_if<Refusal>(&judged)) return *refusal;
  return static_cast<ViewRoute>(std::get<std::size_t>(judged));
}

const Verdict forbidden = Refusal{403};

}  // namespace

TEST_CASE("the address leads to the page", "[viewer][gate]") {
  CHECK(gate.address() == "http://127.0.0.1:8080/" + token + "/");
  CHECK(judge("/" + token + "/") == Verdict(ViewRoute::Page));
  CHECK(judge("/" + token + "/events") == Verdict(ViewRoute::Events));
  CHECK(judge("/" + token + "/picture", {}, "POST") == Verdict(ViewRoute::Picture));
  CHECK(judge("/" + token + "/picture") == Verdict(Refusal{405}));
  CHECK(judge("/" + token + "/else") == Verdict(Refusal{404}));
  CHECK(judge("/" + token) == Verdict(Refusal{404}));
}

TEST_CASE("without the token nobody learns what there is", "[viewer][gate]") {
  for (const char* target : {"", "/", "//", "/else", "/events", "/picture", "*"}) {
    CHECK(judge(target) == forbidden);
    CHECK(judge(target, {}, "POST") == forbidden);
  }
  for (std::size_t length = 0; length < token.size(); ++length) {
    CHECK(judge("/" + token.substr(0, length) + "/") == forbidden);
    std::string other = token;
    other[length] = 'x';
    CHECK(judge("/" + other + "/bake") == forbidden);
  }
}

TEST_CASE("a request without a host is refused", "[viewer][gate]") {
  HttpHead head;
  head.method = "GET";
  head.target = "/" + token + "/";
  CHECK(std::get<Refusal>(gate.judge(head)) == Refusal{403});
}

TEST_CASE("an origin is that of the host it asks", "[viewer][gate]") {
  const std::string page = "/" + token + "/bake";
  CHECK(judge(page, {{"origin", "http://127.0.0.1:8080"}}) == Verdict(ViewRoute::Bake));
  CHECK(judge(page, {{"origin", "http://localhost:8080"}}) == forbidden);
  CHECK(judge(page, {{"origin", "http://localhost:8080"}}, "GET", "localhost:8080") ==
        Verdict(ViewRoute::Bake));
  CHECK(judge(page, {{"origin", "null"}}) == forbidden);
}

TEST_CASE("only the page for pictures is reached from a file, as a page", "[viewer][gate]") {
  const std::vector<HttpField> from_file = {{"sec-fetch-site", "cross-site"},
                                            {"sec-fetch-mode", "navigate"},
                                            {"sec-fetch-dest", "document"}};
  CHECK(judge("/" + token + "/take", from_file) == Verdict(ViewRoute::PicturePage));
  for (const char* place : {"", "events", "bake", "job"}) {
    CHECK(judge("/" + token + "/" + place, from_file) == forbidden);
  }
  for (std::size_t k = 0; k < from_file.size(); ++k) {
    auto fields = from_file;
    fields[k].value = "iframe";
    CHECK(judge("/" + token + "/take", fields) == forbidden);
  }
}

TEST_CASE("a place may have several methods, and words behind a ?", "[viewer][gate]") {
  static constexpr Route routes[] = {
      {""}, {.place = "motion", .has_query = true}, {"motion", "POST"}, {"bare"}};
  const Gate own(token, 8080, routes);
  const auto route_of = [&](const std::string& place, const std::string& method) {
    HttpHead head;
    head.method = method;
    head.target = "/" + token + "/" + place;
    head.fields.push_back({"host", "127.0.0.1:8080"});
    return own.judge(head);
  };
  using Judged = std::variant<std::size_t, Refusal>;
  CHECK(route_of("motion", "GET") == Judged(std::size_t{1}));
  CHECK(route_of("motion?a=1&b", "GET") == Judged(std::size_t{1}));
  CHECK(route_of("motion", "POST") == Judged(std::size_t{2}));
  CHECK(route_of("motion", "PUT") == Judged(Refusal{405}));
  CHECK(route_of("motion?a", "POST") == Judged(Refusal{405}));
  CHECK(route_of("bare", "GET") == Judged(std::size_t{3}));
  CHECK(route_of("bare?", "GET") == Judged(Refusal{404}));
  CHECK(query_of("/x/motion?a=1?b") == "a=1?b");
  CHECK(query_of("/x/motion").empty());
}
