# The command and the page: docs/install.md says how to build and use it.
FROM node:22-slim AS node

FROM python:3.11-slim AS build
# npm fetches the libraries of the page, whose checksums are tested.
COPY --from=node /usr/local/bin/node /usr/local/bin/node
COPY --from=node /usr/local/lib/node_modules/npm /usr/local/lib/node_modules/npm
RUN ln -s ../lib/node_modules/npm/bin/npm-cli.js /usr/local/bin/npm
WORKDIR /source
COPY tools tools
COPY web web
RUN python -m tools.web_runtime
COPY pyproject.toml README.md LICENSE ./
COPY skinnet skinnet
RUN pip wheel --no-cache-dir --no-deps --wheel-dir /wheels .

FROM python:3.11-slim
COPY constraints.txt /tmp/constraints.txt
RUN --mount=type=bind,from=build,source=/wheels,target=/wheels \
    pip install --no-cache-dir -c /tmp/constraints.txt "$(echo /wheels/skinnet-*.whl)[heif,raw]"
RUN useradd --create-home --uid 1000 skinnet
USER 1000
WORKDIR /work
EXPOSE 8765
# The page ends by an interrupt, as by Ctrl-C.
STOPSIGNAL SIGINT
ENTRYPOINT ["skinnet"]
CMD ["--help"]
