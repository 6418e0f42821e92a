# SPDX-License-Identifier: Apache-2.0
# A robot: an integrator's program (client/examples/01_robot) built against the installed client, with what it loads and nothing else.
#   DOCKER_BUILDKIT=1 docker build -f docker/client.Dockerfile -t overtone-client .
FROM debian:bookworm-slim AS build
COPY docker/packages.txt docker/install_packages.sh /packages/
RUN /packages/install_packages.sh client
RUN --mount=type=bind,target=/src,rw --mount=type=cache,id=overtone-ccache,target=/root/.cache/ccache \
    cd /src && docker/build.sh client-only all && cmake --install build/client-only --component client --prefix /usr/local >/dev/null
# Here nothing of Overtone is left but the package: what find_package(overtone) gives is all that the robot is built with.
RUN --mount=type=bind,source=client/examples/01_robot,target=/robot \
    cmake -G Ninja -S /robot -B /build -DCMAKE_BUILD_TYPE=Release >/dev/null && cmake --build /build
RUN --mount=type=bind,target=/src \
    /src/docker/runtime_root.sh /runtime overtone-robot client /build/robot

FROM scratch
COPY --from=build /runtime /
ARG REVISION=unknown
LABEL org.opencontainers.image.title="Overtone example robot" \
      org.opencontainers.image.description="The smallest robot on Overtone's client library" \
      org.opencontainers.image.licenses="Apache-2.0" \
      org.opencontainers.image.version="0.1.0" \
      org.opencontainers.image.revision="${REVISION}" \
      org.opencontainers.image.base.name="scratch"
USER 65532:65532
WORKDIR /var/lib/overtone
STOPSIGNAL SIGTERM
ENTRYPOINT ["/usr/bin/robot"]
