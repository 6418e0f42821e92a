# SPDX-License-Identifier: Apache-2.0
# The dashboard: a small service that is itself only a client of the public API, and its page.
#   DOCKER_BUILDKIT=1 docker build -f docker/dashboard.Dockerfile -t overtone-dashboard .
# Where npm's registry is reached through a proxy with a CA of its own:  --secret id=ca,src=/etc/ssl/certs/ca-certificates.crt
FROM debian:bookworm-slim AS build
COPY docker/packages.txt docker/install_packages.sh /packages/
RUN /packages/install_packages.sh client server web
RUN --mount=type=bind,target=/src,rw --mount=type=cache,id=overtone-ccache,target=/root/.cache/ccache \
    --mount=type=cache,id=overtone-npm,target=/root/.npm --mount=type=secret,id=ca \
    cd /src && NODE_EXTRA_CA_CERTS=/run/secrets/ca docker/build.sh release overtone_dashboard overtone_dashboard_page \
    && PACKAGE_JSON=services/dashboard/web/package.json docker/runtime_root.sh /runtime overtone-dashboard "client server" build/release/services/dashboard/overtone-dashboard \
    && mkdir -p /runtime/usr/share/overtone && cp -r build/release/services/dashboard/web/dist /runtime/usr/share/overtone/dashboard

FROM scratch
COPY --from=build /runtime /
ARG REVISION=unknown
LABEL org.opencontainers.image.title="Overtone dashboard" \
      org.opencontainers.image.description="A page about one map of a mapping server" \
      org.opencontainers.image.licenses="Apache-2.0" \
      org.opencontainers.image.version="0.1.0" \
      org.opencontainers.image.revision="${REVISION}" \
      org.opencontainers.image.base.name="scratch"
USER 65532:65532
WORKDIR /var/lib/overtone
EXPOSE 8080
STOPSIGNAL SIGTERM
ENTRYPOINT ["/usr/bin/overtone-dashboard"]
CMD ["--listen", "0.0.0.0:8080"]
