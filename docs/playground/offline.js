// Keeps what the page needs, so that it works without a network, and asks for news where there is one.
const KEPT = "symflex-playground";
/** Whether an address lies in a folder that is named by what is in it, which never changes. */
const isFixed = (address) => /\/[0-9a-f]{16}\//.test(new URL(address).pathname);
const isHere = (address) => new URL(address).origin === location.origin;

self.addEventListener("install", () => self.skipWaiting());
self.addEventListener("activate", (event) => event.waitUntil(self.clients.claim()));
self.addEventListener("message", (event) => event.waitUntil(keep(event.data)));
self.addEventListener("fetch", (event) => {
    const { request } = event;
    if (request.method === "GET" && isHere(request.url)) event.respondWith(answered(request));
});

/** Keep all of the addresses, and nothing of older programs. */
async function keep(addresses) {
    const cache = await caches.open(KEPT);
    const wanted = addresses.map((address) => new URL(address, location).href).filter(isHere);
    for (const { url } of await cache.keys()) if (isFixed(url) && !wanted.includes(url)) await cache.delete(url);
    await Promise.all(wanted.map(async (address) => (await cache.match(address)) ?? cache.add(address)));
}

async function answered(request) {
    const cache = await caches.open(KEPT);
    const kept = await cache.match(request);
    if (kept && isFixed(request.url)) return kept;
    try {
        const found = await fetch(request);
        if (found.ok) await cache.put(request, found.clone());
        return found;
    } catch (error) {
        if (kept) return kept;
        throw error;
    }
}
