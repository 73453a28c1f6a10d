// Keeps what the page loaded, so that it works without a network, and asks for news where there is one.
const KEPT = "symflex-playground";

self.addEventListener("install", () => self.skipWaiting());
self.addEventListener("activate", (event) => event.waitUntil(self.clients.claim()));
self.addEventListener("fetch", (event) => {
    const { request } = event;
    if (request.method !== "GET" || new URL(request.url).origin !== location.origin) return;
    event.respondWith(answered(request));
});

async function answered(request) {
    const cache = await caches.open(KEPT);
    try {
        const found = await fetch(request);
        if (found.ok) await cache.put(request, found.clone());
        return found;
    } catch (error) {
        const kept = await cache.match(request);
        if (kept) return kept;
        throw error;
    }
}
